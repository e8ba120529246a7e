"""A body that agrees better turned round, time after time, is turned round; one that does so once is not."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.tracking.hypotheses.flip_test import FlipTest, FlipTestParams
from mocapd.tracking.ticks import Ticks
from tests.fit.synthetic import standing

PARAMS = FlipTestParams()


def fit(explained: float, cost: float) -> Fit:
    counts = np.zeros(21)
    visible, matched = counts.copy(), counts.copy()
    visible[1], matched[1] = 1000.0, 1000.0 * explained
    nothing = np.zeros((1, 1))
    return Fit(standing(), visible, matched, counts, nothing, cost, nothing)


def looks(long_turns: Collection[int]) -> list[int]:
    """At which turns it looks, of 60."""
    flip_test, out = FlipTest(PARAMS), []
    for turn in range(60):
        ticks = Ticks(turn, turn, turn)
        if flip_test.is_due(ticks, turn in long_turns):
            flip_test.record_test(ticks)
            out.append(turn)
    return out


def test_it_is_looked_for_now_and_then() -> None:
    assert looks(()) == [11, 21, 31, 41, 51]


def test_a_frame_that_takes_long_anyhow_is_left_alone_for_a_while() -> None:
    assert looks(range(20, 24)) == [11, 25, 35, 45, 55]
    every = looks(range(60))
    assert 3 <= len(every) < 5
    assert max(np.diff(every)) <= 30 * PARAMS.latest_s + 1


def test_once_is_chance_and_again_and_again_is_not() -> None:
    flip_test = FlipTest(PARAMS)
    now, other = fit(0.60, 700.0), fit(0.63, 680.0)
    assert [flip_test.is_better(now, other) for _ in range(3)] == [False, True, True]
    flip_test.reset()
    assert not flip_test.is_better(now, other)


def test_what_speaks_for_the_present_way_takes_back_what_spoke_against_it() -> None:
    flip_test = FlipTest(PARAMS)
    better, worse = fit(0.63, 680.0), fit(0.57, 800.0)
    now = fit(0.60, 700.0)
    for _ in range(20):
        assert not flip_test.is_better(now, better)
        assert not flip_test.is_better(now, worse)


def test_no_way_that_explains_far_less_is_taken_for_its_cost() -> None:
    flip_test = FlipTest(replace(PARAMS, explained=10.0))
    assert not any(flip_test.is_better(fit(0.60, 900.0), fit(0.50, 200.0)) for _ in range(5))
