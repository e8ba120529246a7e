"""Figures of a recording in which something interrupts, of bodies made by hand."""

import json
from pathlib import Path

import numpy as np
import pytest

from lab.pages import interruptions_page as page
from lab.simulated.recorded_set import interrupted
from lab.studies.cue_changes import Interruptions, PublishedBodies, cue_changes, interruptions
from mocapd.calibration.from_origin import from_capture
from mocapd.evaluate.capture_eval import open_case
from mocapd.session.tracker_setup import cache_resources, ready_tracker
from mocapd.types import Floats
from tests.sim.kept_capture import kept_capture
from tests.sim.small import scenario

BOTH, CLOTHES, NOBODY = "shirt+clothes", "clothes", ""


def published(*runs: tuple[str, int]) -> PublishedBodies:
    """So many frames of each."""
    carrier = np.array([name for name, n in runs for _ in range(n)], dtype=np.str_)
    n = len(carrier)
    return PublishedBodies(np.arange(n) / 30.0, carrier, np.zeros((n, 22, 3)))


def found(of: PublishedBodies, in_view: np.ndarray, step_cm: Floats) -> Interruptions:
    return Interruptions(
        "small",
        of,
        in_view,
        step_cm,
        cue_changes(of, in_view, step_cm),
        {BOTH: 2.0, CLOTHES: 5.0},
        0,
    )


def test_a_change_has_the_farthest_step_until_the_pose_has_arrived() -> None:
    of = published((BOTH, 10), (CLOTHES, 15), (BOTH, 5))
    step_cm = np.full(30, 1.0)
    step_cm[[9, 11, 17, 18]] = 30.0, 7.0, 8.0, 40.0  # 9 and 18 are before and after
    first, second = cue_changes(of, np.ones(30, dtype=bool), step_cm)
    assert (first.before, first.after, first.step_cm) == (BOTH, CLOTHES, 8.0)
    assert first.at_s == pytest.approx(10 / 30)
    assert (second.before, second.after, second.step_cm) == (CLOTHES, BOTH, 1.0)


def test_frames_without_a_body_are_part_of_a_change_while_somebody_is_in_view() -> None:
    of = published((BOTH, 10), (NOBODY, 4), (CLOTHES, 10))
    (only,) = cue_changes(of, np.ones(24, dtype=bool), np.full(24, np.nan))
    assert only.at_s == pytest.approx(14 / 30)
    assert np.isnan(only.step_cm)
    away = np.arange(24) != 12
    assert cue_changes(of, away, np.full(24, np.nan)) == ()


def test_what_is_published_counts_while_somebody_is_in_view() -> None:
    of = published((NOBODY, 10), (BOTH, 30), (NOBODY, 10))
    in_view = np.arange(50) >= 8
    in_view[40:] = False
    one = found(of, in_view, np.full(50, np.nan))
    assert one.published == pytest.approx(30 / 32)
    text = page.figures_table(one)
    assert "93.8 %" in text
    assert "never" not in text


def test_tables_name_each_change_and_its_cues() -> None:
    of = published((BOTH, 10), (CLOTHES, 10))
    one = found(of, np.ones(20, dtype=bool), np.full(20, 3.0))
    assert "shirt+clothes to clothes" in page.changes_table(one)
    assert "50" in page.errors_table(one)
    (change,) = json.loads(json.dumps(page.as_json(one)))["changes"]
    assert (change["before"], change["after"]) == (BOTH, CLOTHES)
    assert change["step_cm"] == 3.0


def test_what_interrupts_is_that_of_the_scene() -> None:
    spans = page.spans_of(interrupted().scenario)
    assert set(spans) == {"jacket", "no lamp", "one camera", "nobody there"}
    for when in spans.values():
        assert len(when) == 1
        ((from_s, to_s),) = when
        assert 0.0 < from_s < to_s < 24.0


@pytest.mark.kernels
def test_a_recording_is_looked_at_from_its_first_frame_and_written_as_a_page(
    cache_home: Path, tmp_path: Path
) -> None:
    """The canned body is there all the time, also before the person comes."""
    case = open_case(kept_capture(scenario(person_appears_s=0.2), 1.5, cache_home))
    ready = ready_tracker(
        "canned",
        from_capture(case.folder).assuming(1.7),
        cache_resources(cache_home, lambda *_: None),
    )
    one = interruptions(case, ready, lambda *_: None)
    assert len(one.bodies.times_s) == 45
    assert one.in_view.tolist() == [t >= 0.2 - 1e-6 for t in one.bodies.times_s]
    assert one.published == 1.0
    assert one.ghosts == 6  # nobody was there yet
    assert list(one.error_cm) == ["canned"]
    assert one.error_cm["canned"] > 10.0
    assert np.nanmax(one.step_cm) > 0.5
    assert one.changes == ()
    paths = page.write_page(tmp_path, one, {"jacket": [(0.3, 0.5)]}, "python -m lab.interruptions")
    assert all(path.stat().st_size for path in paths)
    assert "python -m lab.interruptions" in paths[0].read_text()
