"""Half of the cameras in another thread: the same results, in order, and nothing goes on when it returns."""

import threading
import time

import numpy as np
import pytest

from mocapd.each import Each, in_turn
from mocapd.session.side_by_side import side_by_side
from mocapd.trackers.flex.build import build_flex_tracker
from mocapd.trackers.known import known_shape
from mocapd.types import Floats
from tests.trackers.flex.plain_film import N_EMPTY, plain_film


@pytest.mark.parametrize("count", range(6))
def test_results_are_in_order(count: int) -> None:
    assert side_by_side(str, range(count)) == in_turn(str, range(count))


def test_two_are_worked_at_at_once() -> None:
    both = threading.Barrier(2)
    assert len(side_by_side(lambda _: both.wait(30.0), range(2))) == 2


@pytest.mark.parametrize("bad", [0, 1, 2])
def test_what_one_raises_is_raised_when_all_are_done(bad: int) -> None:
    at_work = set(range(4))

    def work(one: int) -> None:
        time.sleep(0.02 * (4 - abs(one - bad)))
        at_work.discard(one)
        if one == bad:
            raise KeyError(one)

    with pytest.raises(KeyError, match=str(bad)):
        side_by_side(work, range(4))
    assert not at_work & {0, 2}  # the first of each half was done
    left = set(at_work)
    time.sleep(0.1)
    assert at_work == left


@pytest.mark.kernels
def test_a_tracker_tells_the_same_to_the_last_bit() -> None:
    assert np.array_equal(_joints(in_turn), _joints(side_by_side))


def _joints(each: Each) -> Floats:
    film = plain_film()
    tracker = build_flex_tracker(film.known, each=each)
    shape, joints = known_shape(film.known), []
    for frames in film.frames[: N_EMPTY + 30]:
        track = tracker.step(frames, shape)
        shape = track.shape
        if track.body.joints_m is not None:
            joints.append(track.body.joints_m)
    assert len(joints) > 5
    return np.array(joints)
