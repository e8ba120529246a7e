"""Figures of a recording in which something interrupts, on what was told by hand."""

import json
from pathlib import Path

import numpy as np
import pytest

from lab.pages import interruptions_page as page
from lab.simulated.recorded_set import interrupted
from lab.studies.speakers import Interruptions, Told, interruptions, switches
from mocapd.calibration.from_origin import from_capture
from mocapd.evaluate.capture_eval import open_case
from mocapd.session.tracker_setup import cached, ready_tracker
from mocapd.types import Floats
from tests.sim.kept_capture import kept_capture
from tests.sim.small import scenario

COLOUR, FLEX, NOBODY = "colour+flex", "flex", ""


def told(*runs: tuple[str, int], gliding: tuple[int, ...] = ()) -> Told:
    """So many frames of each."""
    tracker = np.array([name for name, n in runs for _ in range(n)], dtype=np.str_)
    glides = np.isin(np.arange(len(tracker)), gliding)
    return Told(np.arange(len(tracker)) / 30.0, tracker, glides, np.zeros((len(tracker), 22, 3)))


def found(of: Told, in_view: np.ndarray, step_cm: Floats) -> Interruptions:
    return Interruptions(
        "small", of, in_view, step_cm, switches(of, in_view, step_cm), {COLOUR: 2.0, FLEX: 5.0}, 0
    )


def test_a_switch_lasts_until_the_body_is_the_next_ones_and_has_the_farthest_step_within() -> None:
    of = told((COLOUR, 10), (FLEX, 10), (COLOUR, 5), gliding=(10, 11, 12))
    step_cm = np.full(25, 1.0)
    step_cm[[9, 11, 13, 14]] = 30.0, 7.0, 8.0, 40.0  # 9 and 14 are before and after
    first, second = switches(of, np.ones(25, dtype=bool), step_cm)
    assert (first.before, first.after, first.frames, first.step_cm) == (COLOUR, FLEX, 4, 8.0)
    assert first.at_s == pytest.approx(10 / 30)
    assert (second.before, second.after, second.frames) == (FLEX, COLOUR, 1)


def test_frames_without_a_body_are_part_of_a_switch_while_somebody_is_in_view() -> None:
    of = told((COLOUR, 10), (NOBODY, 4), (FLEX, 10))
    (only,) = switches(of, np.ones(24, dtype=bool), np.full(24, np.nan))
    assert only.frames == 5
    assert np.isnan(only.step_cm)
    away = np.arange(24) != 12
    assert switches(of, away, np.full(24, np.nan)) == ()


def test_what_is_published_counts_while_somebody_is_in_view() -> None:
    of = told((NOBODY, 10), (COLOUR, 30), (NOBODY, 10))
    in_view = np.arange(50) >= 8
    in_view[40:] = False
    one = found(of, in_view, np.full(50, np.nan))
    assert one.published == pytest.approx(30 / 32)
    text = page.figures_table(one)
    assert "93.8 %" in text
    assert "never" not in text


def test_tables_name_each_switch_and_speaker() -> None:
    of = told((COLOUR, 10), (FLEX, 10))
    one = found(of, np.ones(20, dtype=bool), np.full(20, 3.0))
    assert "colour+flex to flex" in page.switches_table(one)
    assert "50" in page.errors_table(one)
    (switch,) = json.loads(json.dumps(page.as_json(one)))["switches"]
    assert (switch["before"], switch["after"], switch["frames"]) == (COLOUR, FLEX, 1)
    assert switch["step_cm"] == 3.0


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
        "canned", from_capture(case.folder).assuming(1.7), cached(cache_home, lambda *_: None)
    )
    one = interruptions(case, ready, lambda *_: None)
    assert len(one.told.times_s) == 45
    assert one.in_view.tolist() == [t >= 0.2 - 1e-6 for t in one.told.times_s]
    assert one.published == 1.0
    assert one.ghosts == 6  # nobody was there yet
    assert list(one.error_cm) == ["canned"]
    assert one.error_cm["canned"] > 10.0
    assert np.nanmax(one.step_cm) > 0.5
    assert one.switches == ()
    paths = page.write_page(tmp_path, one, {"jacket": [(0.3, 0.5)]}, "python -m lab.interruptions")
    assert all(path.stat().st_size for path in paths)
    assert "python -m lab.interruptions" in paths[0].read_text()
