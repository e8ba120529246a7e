"""Half of the cameras in a thread of its own, so that a frame set takes little longer than a frame."""

import os
from collections.abc import Callable, Iterable
from functools import cache, partial
from queue import SimpleQueue
from threading import Thread
from typing import TypeVar

from mocapd.each import Each, in_turn

T = TypeVar("T")
R = TypeVar("R")


def each_camera() -> Each:
    """See Each; in turn where there is one processor."""
    return side_by_side if len(os.sched_getaffinity(0)) > 1 else in_turn


def side_by_side(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each. The caller does the first half."""
    things = list(of)
    if len(things) < 2:
        return in_turn(work, things)
    half = (len(things) + 1) // 2
    done: SimpleQueue[list[R] | BaseException] = SimpleQueue()
    _other().put(partial(_do, work, things[half:], done))
    try:
        mine = in_turn(work, things[:half])
    finally:
        others = done.get()
    if isinstance(others, BaseException):
        raise others
    return mine + others


def _do(
    work: Callable[[T], R], of: Iterable[T], done: "SimpleQueue[list[R] | BaseException]"
) -> None:
    """Tell what came of it, or what was raised."""
    try:
        done.put(in_turn(work, of))
    except BaseException as error:  # noqa: BLE001 - raised where it was asked for
        done.put(error)


@cache
def _other() -> "SimpleQueue[Callable[[], None]]":
    """What one thread does for all trackers of the process: a pipeline steps one at a time. Bare queues, as the twenty halves
    of a frame set would wait half a millisecond for an executor's futures."""
    jobs: SimpleQueue[Callable[[], None]] = SimpleQueue()
    Thread(target=_serve, args=(jobs,), name="cameras", daemon=True).start()
    return jobs


def _serve(jobs: "SimpleQueue[Callable[[], None]]") -> None:
    while True:
        jobs.get()()
