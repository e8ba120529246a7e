"""Half of the cameras in another thread: the same results, in order, and nothing goes on when it returns."""

import threading
import time
from functools import partial

import numpy as np
import pytest

from mocapd.each import Each, in_turn
from mocapd.session.side_by_side import in_other_thread, side_by_side
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


def test_what_is_done_aside_goes_on_meanwhile_and_is_waited_for() -> None:
    both, done = threading.Barrier(2), list[int]()

    def work() -> None:
        both.wait(30.0)
        done.append(threading.get_ident())

    wait = in_other_thread(work)
    both.wait(30.0)
    wait()
    assert len(done) == 1
    assert done != [threading.get_ident()]


def test_what_fails_aside_is_raised_where_it_is_waited_for() -> None:
    wait = in_other_thread(partial(int, "nothing"))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="nothing"):
        wait()


def test_whoever_waits_for_work_that_nobody_began_does_it() -> None:
    go_on, at_work = threading.Event(), threading.Event()

    def long() -> None:
        at_work.set()
        go_on.wait(30.0)

    wait = in_other_thread(long)
    at_work.wait(30.0)
    # the other thread is busy
    assert side_by_side(lambda _: threading.get_ident(), range(2)) == [threading.get_ident()] * 2
    go_on.set()
    wait()


def test_the_other_thread_does_its_own_cameras_in_turn_while_nobody_waits() -> None:
    who, over = list[int](), threading.Event()

    def work() -> None:
        who.extend(side_by_side(lambda _: threading.get_ident(), range(4)))
        over.set()

    wait = in_other_thread(work)
    over.wait(30.0)
    wait()
    assert len(who) == 4
    assert len(set(who)) == 1


def test_whoever_waits_for_the_other_thread_does_half_of_its_cameras() -> None:
    who, began, go_on = list[int](), threading.Event(), threading.Event()

    def look(camera: int) -> int:
        if camera == 0:
            began.set()
            go_on.wait(30.0)
        else:
            go_on.set()  # the other half was done meanwhile
        return threading.get_ident()

    wait = in_other_thread(lambda: who.extend(side_by_side(look, range(2))))
    began.wait(30.0)
    wait()
    assert who[0] != who[1] == threading.get_ident()


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
