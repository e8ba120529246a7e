"""The commands of the lab as we run them, on a capture that the simulator exported."""

from pathlib import Path

import pytest

from lab.evaluation import evaluation
from mocapd.errors import ConfigError
from tests.lab.lab_process import lab
from tests.sim.kept_capture import kept_capture
from tests.sim.small import scenario

pytestmark = pytest.mark.kernels

# as in tests/evaluate/test_command.py and test_roc_of_capture.py, so that one capture serves all
SECONDS, APPEARS_S = 1.1, 0.2


@pytest.fixture(scope="module")
def capture(cache_home: Path) -> Path:
    return kept_capture(scenario(person_appears_s=APPEARS_S), SECONDS, cache_home)


def test_the_published_tracker_is_set_beside_itself_without_each_of_its_steps(
    capture: Path, clean_env: dict[str, str], tmp_path: Path
) -> None:
    words = ("small", "--tracker", "hecht2009", "--compare", "--out", tmp_path)
    outcome = lab(clean_env, "evaluation", *words, cwd=capture.parent)
    assert outcome.code == 0, outcome.err
    compared = next(line for line in outcome.out.splitlines() if line.startswith("| RMS"))
    assert [cell.strip() for cell in compared.split("|")[2:-1]] == [
        "full", "no depth noise", "no particle constraints", "no occlusion", "no appearance",
    ]  # fmt: skip
    text = (tmp_path / "evaluation.md").read_text()
    assert "python -m lab.evaluation small --tracker hecht2009 --compare --out " in text


def test_only_trackers_that_have_rivals_are_compared(
    capture: Path, empty_home: Path, cache_home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_home))
    with pytest.raises(ConfigError, match=r"'canned' has no baseline.*--tracker shirt") as told:
        evaluation([capture], "canned", compare_with_rivals=True)
    assert told.value.exit_code == 78


def test_predictions_of_a_still_body_are_scored(capture: Path, clean_env: dict[str, str]) -> None:
    outcome = lab(clean_env, "prediction", capture, "--tracker", "canned")
    assert outcome.code == 0, outcome.err
    assert [line.split()[1] for line in outcome.out.splitlines()[2:]] == ["small", "all"]
