"""A second thread for a tracker: half of its cameras, so that a frame set takes little longer than a frame, and what can be
done before all is known.

Whoever waits for work, or for a part of it, that nobody began yet does it: a processor that slept wakes late.
"""

import os
from collections import deque
from collections.abc import Callable, Iterable
from functools import cache
from queue import SimpleQueue
from threading import Lock, Thread, get_ident
from typing import Any, Generic, NamedTuple, TypeVar, cast

from mocapd.each import Aside, Each, at_once, in_turn

T = TypeVar("T")
R = TypeVar("R")


def each_camera() -> Each:
    """See Each; in turn where there is one processor."""
    return side_by_side if _are_two() else in_turn


def aside() -> Aside:
    """See Aside; at once where there is one processor."""
    return in_other_thread if _are_two() else at_once


def side_by_side(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each. The caller does the first half; in the other thread the second half is for who waits for that, if they come
    in time."""
    things = list(of)
    if len(things) < 2:
        return in_turn(work, things)
    other = _other()
    half = (len(things) + 1) // 2
    job = _Job(lambda: in_turn(work, things[half:]))
    if get_ident() == other.ident:
        other.offered.append(job)
    else:
        other.jobs.put(job)
    try:
        mine = in_turn(work, things[:half])
    finally:
        job.end()
    return mine + job.result()


def in_other_thread(work: Callable[[], None]) -> Callable[[], None]:
    """See Aside."""
    job, other = _Job(work), _other()
    other.jobs.put(job)

    def wait() -> None:
        job.do()
        while other.offered:
            other.offered.pop().do()
        job.result()

    return wait


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


class _Other(NamedTuple):
    jobs: "SimpleQueue[_Job[Any]]"
    offered: "deque[_Job[Any]]"  # the newest part of what it does that another thread may do; begun or not
    ident: int | None


@cache
def _other() -> _Other:
    """What one thread does for all trackers of the process: a pipeline steps one at a time. A bare queue and bare locks, as
    the twenty halves of a frame set would wait half a millisecond for an executor's futures."""
    jobs: SimpleQueue[_Job[Any]] = SimpleQueue()
    thread = Thread(target=_serve, args=(jobs,), name="cameras", daemon=True)
    thread.start()
    return _Other(jobs, deque(maxlen=1), thread.ident)


def _serve(jobs: "SimpleQueue[_Job[Any]]") -> None:
    while True:
        jobs.get().do()


def _are_two() -> bool:
    return len(os.sched_getaffinity(0)) > 1
