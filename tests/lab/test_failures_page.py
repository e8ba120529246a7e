"""The scenes of the published tracker's failures, as scored: when each was right again, and what the page says of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lab.pages import failures_page as page
from lab.simulated.failure_scenes import FAILURE_SCENES
from lab.simulated.recorded_set import failures
from lab.simulated.session_plan import PlannedSession
from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.recovery import recovery
from mocapd.types import Floats
from tests.evaluate.results import result_of
from tests.evaluate.tracks import EMPTY, FRAMES

HIDDEN = EMPTY + 30  # the frame in which somebody is in the open again


def as_tracked(session: PlannedSession, error_m: Floats) -> CaptureResult:
    """A session in which nothing hides the person from frame HIDDEN on."""
    result = result_of(session.name, error_m)
    truth = replace(result.case.truth, clear_s=float(result.case.truth.times_s[HIDDEN]))
    case = replace(result.case, truth=truth)
    return replace(result, case=case, recovery_frames=recovery(truth, result.track))


def scenes() -> list[PlannedSession]:
    """Of the close pair, as short as the results."""
    clear_s = float(result_of("any", 0.0).case.truth.times_s[HIDDEN])
    return [replace(one, clear_s=clear_s) for one in failures() if "_stereo_" in one.name]


def test_each_scene_says_when_it_is_right_again_and_how_far_off_it_was() -> None:
    late = np.full(FRAMES, 0.03)
    late[:HIDDEN] = 0.3
    late[HIDDEN : HIDDEN + 12] = 0.2
    good, bad, *_ = scenes()
    found = page.outcomes(
        [good, bad], [as_tracked(good, late), as_tracked(bad, late + 0.2)], "upper"
    )
    assert [(one.scene, one.rig) for one in found] == [
        (FAILURE_SCENES[0].name, "stereo"), (FAILURE_SCENES[1].name, "stereo"),
    ]  # fmt: skip
    assert found[0].back_s == pytest.approx(12 / 30.0)
    assert found[1].back_s == np.inf
    assert found[0].hidden_cm == pytest.approx(30.0)
    first, second = page.outcomes_table(found).splitlines()[2:]
    assert "0.40" in first
    assert "30.0" in first
    assert "never" in second
    assert [one["back_s"] for one in page.as_json(found)] == [pytest.approx(0.4), "never"]


def test_a_recording_that_is_no_such_scene_is_left_out() -> None:
    others = [one for one in failures() if one.clear_s is None]
    assert [one.name for one in others] == ["interruptions"]
    assert page.outcomes(others, [result_of(others[0].name, 0.1)], "upper") == []


def test_the_page_names_the_command_every_scene_and_its_remedy(tmp_path: Path) -> None:
    sessions = scenes()
    results = [as_tracked(one, np.full(FRAMES, 0.02)) for one in sessions]
    found = page.outcomes(sessions, results, "upper")
    paths = page.write_page(tmp_path, found, "markerless", "full", "python -m lab.failures")
    assert all(path.stat().st_size for path in paths)
    text = paths[0].read_text()
    assert "python -m lab.failures" in text
    for scene in FAILURE_SCENES:
        assert f"- `{scene.name}`: " in text
        assert f"| {scene.name} " in text
    other = page.write_page(tmp_path, found, "canned", "full", "python -m lab.failures")[0]
    assert "remedy" not in other.read_text()  # they are those of one tracker
