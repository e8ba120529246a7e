"""Work that is not done in every frame set falls due by the clock of the frames, at any rate and after gaps."""

import numpy as np
import pytest

from mocapd.clock import nanoseconds
from mocapd.tracking.ticks import TickClock, Ticks

RATES = pytest.mark.parametrize("hz", [15.0, 24.0, 25.0, 30.0, 50.0, 60.0, 90.0])
LASTS_S = 20.0
DAY_S = 86_400.0


def passed(times_s: np.ndarray) -> list[Ticks]:
    clock = TickClock()
    return [clock.pass_to(nanoseconds(DAY_S + at_s)) for at_s in times_s.tolist()]


def at_rate(hz: float) -> np.ndarray:
    return np.arange(round(LASTS_S * hz)) / hz


def test_at_30_hz_each_frame_is_a_tick_also_with_jitter() -> None:
    rng = np.random.default_rng(1)
    for jitter_s in (0.0, 0.004):
        shown = passed(at_rate(30.0) + jitter_s * rng.uniform(-1.0, 1.0, 600))
        assert [one.last for one in shown] == list(range(1, 601))
        assert [one.due(1 / 3) for one in shown] == [n % 10 == 0 for n in range(1, 601)]
        assert [one.due(0.1, 1 / 30) for one in shown] == [n % 3 == 1 for n in range(1, 601)]
        assert [one.alternates(2, 0) for one in shown] == [n % 2 == 0 for n in range(1, 601)]


@RATES
@pytest.mark.parametrize("every_s", [0.1, 1 / 3, 13 / 30])
def test_work_is_due_as_often_at_any_rate(hz: float, every_s: float) -> None:
    due = sum(one.due(every_s) for one in passed(at_rate(hz)))
    assert due == pytest.approx(LASTS_S / every_s, rel=0.05)


@RATES
def test_what_alternates_gets_its_turns_as_often_before_slow_cameras(hz: float) -> None:
    shown = passed(at_rate(hz))
    turns = [sum(one.alternates(2, kind) for one in shown) for kind in (0, 1)]
    if hz > 15.0:
        assert not any(one.alternates(2, 0) and one.alternates(2, 1) for one in shown)
    each = LASTS_S * (15.0 if hz == 15.0 else min(hz, 30.0) / 2)
    assert turns == pytest.approx([each, each], rel=0.05)


def test_frames_that_were_skipped_delay_no_work() -> None:
    rng = np.random.default_rng(2)
    times_s = at_rate(30.0)
    shown = passed(times_s[rng.random(len(times_s)) < 0.5])
    assert sum(one.due(1 / 3) for one in shown) == pytest.approx(60, abs=2)
    kinds = np.array([one.alternates(2, 0) for one in shown])
    assert 0.45 < kinds.mean() < 0.55


def test_after_a_pause_work_is_due_once() -> None:
    first, second = passed(np.array([0.0, 5.0]))
    assert (first.last, second.count) == (1, 150)
    assert second.due(1 / 3)


def test_the_same_times_give_the_same_ticks_and_equal_times_none() -> None:
    times_s = np.cumsum(np.random.default_rng(3).uniform(0.0, 0.1, 100))
    assert passed(times_s) == passed(times_s)
    assert passed(np.array([1.0, 1.0]))[1].count == 0
