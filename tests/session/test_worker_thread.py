"""Cameras shared with another thread: the same results, in order, and nothing goes on when it returns."""

import threading
import time

import numpy as np
import pytest

from mocapd.each import Each, in_turn
from mocapd.session.worker_thread import map_in_two_threads
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Floats
from tests.tracking.plain_film import N_EMPTY, plain_film
from tests.tracking.profiles import markerless_tracker


@pytest.mark.parametrize("count", range(6))
def test_results_are_in_order(count: int) -> None:
    assert map_in_two_threads(str, range(count)) == in_turn(str, range(count))


def test_two_are_worked_at_at_once() -> None:
    both = threading.Barrier(2)
    assert len(map_in_two_threads(lambda _: both.wait(30.0), range(2))) == 2


@pytest.mark.parametrize("bad", [0, 1, 2])
def test_what_one_raises_is_raised_when_all_are_done(bad: int) -> None:
    at_work = set(range(4))

    def work(one: int) -> None:
        time.sleep(0.02 * (4 - abs(one - bad)))
        at_work.discard(one)
        if one == bad:
            raise KeyError(one)

    with pytest.raises(KeyError, match=str(bad)):
        map_in_two_threads(work, range(4))
    assert not at_work


def test_whoever_is_done_takes_the_next() -> None:
    """While the other thread is at work on one that takes long."""
    rest_done, done = threading.Event(), list[int]()

    def look(camera: int) -> None:
        if camera == 0:
            rest_done.wait(30.0)
        done.append(camera)
        if len(done) == 3:
            rest_done.set()

    map_in_two_threads(look, range(4))
    assert done == [1, 2, 3, 0]


def test_whoever_waits_for_work_that_nobody_began_does_it() -> None:
    """While the other thread is busy for somebody else."""
    go_on, at_work, who = threading.Event(), threading.Event(), list[int]()

    def busy(one: int) -> None:
        if one == 1:
            at_work.set()
        go_on.wait(30.0)

    long = threading.Thread(target=map_in_two_threads, args=(busy, range(2)))
    long.start()
    at_work.wait(30.0)
    who += map_in_two_threads(lambda _: threading.get_ident(), range(2))
    go_on.set()
    long.join()
    assert who == [threading.get_ident()] * 2


def test_work_begun_while_the_other_thread_waits_is_done_by_whoever_began_it() -> None:
    who, waits, over = list[int](), list[int](), threading.Event()

    def look(camera: int) -> None:
        if camera == 0:
            waits.append(threading.get_ident())
            over.wait(30.0)
            return
        who.extend(map_in_two_threads(lambda _: threading.get_ident(), range(4)))
        over.set()

    map_in_two_threads(look, range(2))
    assert len(who) == 4
    assert len(set(who)) == 1
    assert who[0] not in waits


@pytest.mark.kernels
def test_a_tracker_finds_the_same_to_the_last_bit() -> None:
    assert np.array_equal(_joints(in_turn), _joints(map_in_two_threads))


def _joints(each: Each) -> Floats:
    film = plain_film()
    tracker = markerless_tracker(film.known, each=each)
    shape, joints = wearer_shape(film.known), []
    for frames in film.frames[: N_EMPTY + 30]:
        track = tracker.step(frames, shape)
        shape = track.shape
        if track.body.joints_m is not None:
            joints.append(track.body.joints_m)
    assert len(joints) > 5
    return np.array(joints)
