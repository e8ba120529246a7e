"""`mocapd eval` as a user runs it, on a capture that the simulator exported."""

import importlib.util
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.cli.mocapd_process import mocapd, mocapd_here
from tests.sim.kept_capture import kept_capture
from tests.sim.small import LAMP_OFF_S, scenario

pytestmark = pytest.mark.kernels

SECONDS, APPEARS_S = 1.1, 0.2


@pytest.fixture(scope="module")
def capture(cache_home: Path) -> Path:
    return kept_capture(scenario(person_appears_s=APPEARS_S), SECONDS, cache_home)


def test_its_help_has_an_example(clean_env: dict[str, str]) -> None:
    outcome = mocapd_here(clean_env, "eval", "--help")
    assert outcome.code == 0
    assert "Example: mocapd eval" in outcome.out


def test_it_prints_a_table_and_writes_the_page(
    capture: Path, clean_env: dict[str, str], tmp_path: Path
) -> None:
    words = ("eval", "small", "--tracker", "canned", "--out", tmp_path)
    outcome = mocapd(clean_env, *words, cwd=capture.parent)
    assert outcome.code == 0, outcome.err
    header, rule, row = outcome.out.splitlines()
    assert header.startswith("| capture ")
    assert set(rule) <= set("|-: ")
    # the canned body is there from the first frame, so the empty room has ghosts
    told = row.split()
    assert told[1:6:2] == ["small", "100.0", "6"]
    assert "evaluation.md: written" in outcome.err
    text = (tmp_path / "evaluation.md").read_text()
    assert outcome.out.strip() in re.sub(r"[\d.]+ \|$", told[-2] + " |", text, flags=re.M)
    assert "mocapd eval small --tracker canned --out " in text


def test_the_page_names_the_settings_that_its_scores_depend_on(
    capture: Path, clean_env: dict[str, str], tmp_path: Path
) -> None:
    config = tmp_path / "hall.toml"
    config.write_text("[tracker]\ncoast_s = 2.0\n")
    settings = ("--config", config, "--set", "tracker.stature_m=1.9", "--set", "zenoh.port=7450")
    words = ("eval", capture, "--tracker", "canned", "--out", tmp_path, *settings)
    outcome = mocapd_here(clean_env, *words)
    assert outcome.code == 0, outcome.err
    text = (tmp_path / "evaluation.md").read_text()
    assert re.search(r" --config \S*hall\.toml --set tracker\.stature_m=1\.9 --out ", text)


def test_json_holds_the_same_figures_as_the_tables(
    capture: Path, clean_env: dict[str, str]
) -> None:
    outcome = mocapd_here(clean_env, "eval", capture, capture, "--tracker", "canned", "--json")
    assert outcome.code == 0, outcome.err
    told = json.loads(outcome.out)
    assert told["tracker"] == "canned"
    first, second = told["captures"]
    assert first["capture"] == "small"
    assert first["coverage_percent"] == 100.0
    assert first["ghost_frames"] == round(APPEARS_S * 30)
    # scored from half a second after the person came, a lamp going out in between
    assert first["frames"] == round((SECONDS - APPEARS_S - 0.5) * 30)
    assert LAMP_OFF_S < SECONDS
    assert first["recovery_frames"] == "never"  # it does not look
    assert first["rms_cm"] > 5.0
    assert len(first["per_joint_rms_cm"]) == 8
    assert told["means"]["mean of 2 with 2 cameras"]["rms_cm"] == pytest.approx(first["rms_cm"])
    assert {k: v for k, v in first.items() if k != "step_ms"} == {
        k: v for k, v in second.items() if k != "step_ms"
    }


def test_a_capture_without_truth_is_one_clear_line(
    capture: Path, clean_env: dict[str, str], tmp_path: Path
) -> None:
    blind = tmp_path / "blind"
    shutil.copytree(capture, blind)
    (blind / "truth.npz").unlink()
    outcome = mocapd_here(clean_env, "eval", capture, blind, "--tracker", "canned")
    assert outcome.code == 66
    assert outcome.out == ""
    assert outcome.err.count("\n") == 1
    assert str(blind / "truth.npz") in outcome.err


@pytest.mark.parametrize(
    ("words", "module"),
    [
        (("--compare", "baseline"), "lab.evaluation"),
        (("--simulated", "clips"), "lab.evaluation"),
        (("--clothes", "plain"), "lab.evaluation"),
        (("--failures",), "lab.failures"),
        (("--interruptions",), "lab.interruptions"),
        (("--prediction",), "lab.prediction"),
    ],
)
def test_an_option_that_moved_to_the_checkout_is_answered_with_its_command(
    words: tuple[str, ...], module: str, clean_env: dict[str, str]
) -> None:
    outcome = mocapd_here(clean_env, "eval", "capture", *words)
    assert outcome.code == 2
    assert words[0] in outcome.err
    assert f"python -m {module}" in outcome.err
    assert outcome.err.count("\n") == 1
    assert importlib.util.find_spec(module) is not None


def test_truth_is_for_scoring_only(capture: Path) -> None:
    """No module below this package knows where the truth is."""
    package = Path(__file__).resolve().parents[2] / "mocapd"
    readers = {
        path.relative_to(package).parts[0]
        for path in package.rglob("*.py")
        if "truth.npz" in path.read_text() or '"labels"' in path.read_text()
    }
    assert readers <= {"evaluate", "cli"}  # the help names it
    assert np.load(capture / "truth.npz")["visible"].any()
