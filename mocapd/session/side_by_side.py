"""A second thread for a tracker: half of its cameras, so that a frame set takes little longer than a frame.

Whoever waits for work, or for a part of it, that nobody began yet does it: a processor that slept wakes late.
"""

import os
from collections.abc import Callable, Iterable
from functools import cache
from queue import SimpleQueue
from threading import Lock, Thread
from typing import Any, Generic, TypeVar, cast

from mocapd.each import Each, in_turn

T = TypeVar("T")
R = TypeVar("R")


def each_camera() -> Each:
    """See Each; in turn where there is one processor."""
    return side_by_side if _are_two() else in_turn


def side_by_side(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each. The caller does the first half; in the other thread the second half is for who waits for that, if they come
    in time."""
    things = list(of)
    if len(things) < 2:
        return in_turn(work, things)
    half = (len(things) + 1) // 2
    job = _Job(lambda: in_turn(work, things[half:]))
    _jobs_of_other_thread().put(job)
    try:
        mine = in_turn(work, things[:half])
    finally:
        job.end()
    return mine + job.result()


class _Job(Generic[R]):
    """Work that is done once, by who comes first: the other thread, or who waits for it."""

    def __init__(self, work: Callable[[], R]) -> None:
        self._work, self._begun, self._over = work, Lock(), Lock()
        self._over.acquire()
        self._result: R | None = None
        self._error: BaseException | None = None

    def do(self) -> None:
        """Unless somebody began."""
        if not self._begun.acquire(blocking=False):
            return
        try:
            self._result = self._work()
        except BaseException as error:  # noqa: BLE001 - raised where it was asked for
            self._error = error
        finally:
            self._over.release()

    def end(self) -> None:
        """Return when it is done."""
        self.do()
        with self._over:
            pass

    def result(self) -> R:
        """What came of it when it is done; raises what it raised."""
        self.end()
        if self._error is not None:
            raise self._error
        return cast(R, self._result)


@cache
def _jobs_of_other_thread() -> "SimpleQueue[_Job[Any]]":
    """What one thread does for all trackers of the process: a pipeline steps one at a time. A bare queue and bare locks, as
    the twenty halves of a frame set would wait half a millisecond for an executor's futures."""
    jobs: SimpleQueue[_Job[Any]] = SimpleQueue()
    Thread(target=_serve, args=(jobs,), name="cameras", daemon=True).start()
    return jobs


def _serve(jobs: "SimpleQueue[_Job[Any]]") -> None:
    while True:
        jobs.get().do()


def _are_two() -> bool:
    return len(os.sched_getaffinity(0)) > 1
