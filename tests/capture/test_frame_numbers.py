"""Frames that a webcam lost show as gaps in the numbers; a longer exposure and a late reader do not."""

from collections.abc import Iterable

import numpy as np
import pytest

from mocapd.capture.webcam.frame_numbers import FrameNumbers

MS = 1_000_000
PERIOD_NS = 33_333_333
DELAY_NS = 20 * MS  # from the exposure until the buffer is given back


def lost_of(stamps_ns: Iterable[int], numbers: FrameNumbers | None = None) -> int:
    """Frames that are counted as lost; each buffer is given back in time."""
    counter = numbers if numbers is not None else FrameNumbers()
    given = [counter.number(stamp_ns, stamp_ns + DELAY_NS) for stamp_ns in stamps_ns]
    return given[-1] - given[0] - (len(given) - 1)


def steady(count: int, period_ns: int = PERIOD_NS, begin_ns: int = 0) -> list[int]:
    return [begin_ns + k * period_ns for k in range(count)]


@pytest.mark.parametrize("share", [0.05, 0.3, 0.6])
def test_frames_that_the_camera_lost_are_counted(share: float) -> None:
    arrives = np.random.default_rng(1).random(600) >= share
    arrives[:20] = True  # the period is known by then
    arrives[-1] = True
    stamps_ns = [k * PERIOD_NS for k in np.flatnonzero(arrives).tolist()]
    assert lost_of(stamps_ns) == pytest.approx(np.count_nonzero(~arrives), rel=0.05)


def test_stamps_that_jitter_by_a_fifth_of_a_period_lose_nothing_and_hide_nothing() -> None:
    jitter_ns = np.random.default_rng(2).uniform(-3.3 * MS, 3.3 * MS, 600)
    stamps_ns = [k * PERIOD_NS + int(jitter_ns[k]) for k in range(600)]
    assert lost_of(stamps_ns) == 0
    missing = [one for k, one in enumerate(stamps_ns) if k not in (300, 400, 401)]
    assert lost_of(missing) == 3


@pytest.mark.parametrize("period_ns", [40 * MS, 50 * MS, 2 * PERIOD_NS, 4 * PERIOD_NS])
def test_a_camera_that_exposes_longer_in_the_dark_loses_nothing_for_long(period_ns: int) -> None:
    bright = steady(60)
    numbers = FrameNumbers()
    assert lost_of(bright, numbers) == 0
    lost_of(steady(16, period_ns, bright[-1] + period_ns), numbers)  # the new period is learned
    assert lost_of(steady(100, period_ns, bright[-1] + 17 * period_ns), numbers) == 0


def test_a_late_reader_is_no_camera_that_loses_frames() -> None:
    numbers = FrameNumbers()
    lost_of(steady(30), numbers)
    last = numbers.number(30 * PERIOD_NS, 30 * PERIOD_NS + DELAY_NS + 5 * PERIOD_NS)
    assert numbers.number(36 * PERIOD_NS, 36 * PERIOD_NS + DELAY_NS) == last + 1


def test_a_camera_that_was_away_begins_again() -> None:
    numbers = FrameNumbers()
    lost_of(steady(30), numbers)
    before = numbers.number(30 * PERIOD_NS, 30 * PERIOD_NS + DELAY_NS)
    numbers.restart()
    assert numbers.number(90 * PERIOD_NS, 90 * PERIOD_NS + DELAY_NS) == before + 1


def test_without_a_drivers_stamps_frames_are_counted_as_they_come() -> None:
    numbers = FrameNumbers()
    assert [numbers.number(None, k * k * PERIOD_NS) for k in range(20)] == list(range(20))


def test_stamps_that_stand_still_or_run_back_lose_nothing() -> None:
    assert lost_of([5 * PERIOD_NS] * 20) == 0
    assert lost_of(reversed(steady(20))) == 0
