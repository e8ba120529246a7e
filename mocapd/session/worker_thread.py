"""A worker thread beside the tracker's own, so that a frame set of several cameras takes little longer than half of them.

Both take cameras from the same heap: whoever is done first takes the next, as cameras take unlike long and an idle processor
wakes late.
"""

import os
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from itertools import count
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
    """See Each. The caller and the worker thread take one after another; what one raises is raised when all are done."""
    things = list(of)
    if len(things) < 2:
        return in_turn(work, things)
    job = _Job(work, things)
    _worker_queue().put(job)
    return job.results()


class _Job(Generic[T, R]):
    """Work on several things, each of which is taken once, by whichever thread comes first."""

    def __init__(self, work: Callable[[T], R], things: Sequence[T]) -> None:
        self._work, self._things = work, things
        self._results: list[R | None] = [None] * len(things)
        self._error: BaseException | None = None
        self._next, self._at_work = count(), Lock()

    def help(self) -> None:
        """The worker thread's part."""
        with self._at_work:
            self._take()

    def results(self) -> list[R]:
        """The caller's part; the results in order, or the exception, of all."""
        self._take()
        with self._at_work:  # by now the other thread holds it, or finds nothing left
            pass
        if self._error is not None:
            raise self._error
        return cast(list[R], self._results)

    def _take(self) -> None:
        while (i := next(self._next)) < len(self._things):
            try:
                self._results[i] = self._work(self._things[i])
            except BaseException as error:  # noqa: BLE001 - `results` raises it
                self._error = error


@cache
def _worker_queue() -> "SimpleQueue[_Job[Any, Any]]":
    """The queue of one worker thread for all trackers of the process. A bare queue and bare locks: an executor's futures
    would cost half a millisecond for the twenty jobs of a frame set."""
    jobs: SimpleQueue[_Job[Any, Any]] = SimpleQueue()
    Thread(target=_serve, args=(jobs,), name="cameras", daemon=True).start()
    return jobs


def _serve(jobs: "SimpleQueue[_Job[Any, Any]]") -> None:
    while True:
        jobs.get().help()


def _has_two_processors() -> bool:
    return len(os.sched_getaffinity(0)) > 1
