"""A worker thread for half of a tracker's cameras, so that a frame set takes little longer than one frame.

A caller that waits for a job which has not started runs it itself, as an idle processor wakes late.
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
    """The map over cameras, see Each: sequential on one processor."""
    return map_in_two_threads if _has_two_processors() else in_turn


def map_in_two_threads(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each. The caller runs the first half, the worker thread the second; the caller takes over a second half that has
    not started."""
    things = list(of)
    if len(things) < 2:
        return in_turn(work, things)
    half = (len(things) + 1) // 2
    job = _Job(lambda: in_turn(work, things[half:]))
    _worker_queue().put(job)
    try:
        results = in_turn(work, things[:half])
    finally:
        job.end()
    return results + job.result()


class _Job(Generic[R]):
    """Work that runs once: in the worker thread, or in the waiting thread if that comes first."""

    def __init__(self, work: Callable[[], R]) -> None:
        self._work, self._begun, self._over = work, Lock(), Lock()
        self._over.acquire()
        self._result: R | None = None
        self._error: BaseException | None = None

    def do(self) -> None:
        """Runs the work unless it has started."""
        if not self._begun.acquire(blocking=False):
            return
        try:
            self._result = self._work()
        except BaseException as error:  # noqa: BLE001 - `result` raises it
            self._error = error
        finally:
            self._over.release()

    def end(self) -> None:
        """Runs or awaits the work."""
        self.do()
        with self._over:
            pass

    def result(self) -> R:
        """The result, or the exception, of the work."""
        self.end()
        if self._error is not None:
            raise self._error
        return cast(R, self._result)


@cache
def _worker_queue() -> "SimpleQueue[_Job[Any]]":
    """The queue of one worker thread for all trackers of the process. A bare queue and bare locks: an executor's futures
    would cost half a millisecond for the twenty jobs of a frame set."""
    jobs: SimpleQueue[_Job[Any]] = SimpleQueue()
    Thread(target=_serve, args=(jobs,), name="cameras", daemon=True).start()
    return jobs


def _serve(jobs: "SimpleQueue[_Job[Any]]") -> None:
    while True:
        jobs.get().do()


def _has_two_processors() -> bool:
    return len(os.sched_getaffinity(0)) > 1
