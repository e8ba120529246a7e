"""The one job that a step has running: in a thread of its own, forgotten when its step is left."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from mocapd.wizard.step import T, Tell


class StepJob:
    """Used by the wizard's thread; the job itself runs in another."""

    def __init__(self) -> None:
        self._worker = _worker()
        self._future: Future[Any] | None = None
        self._done: Callable[[Any], None] | None = None
        self._told: list[tuple[str, float]] = []  # by the job that runs; each job has its own

    @property
    def progress(self) -> tuple[str, float] | None:
        """What the job says of itself and its share 0..1; None without one."""
        return self._told[0] if self._future is not None else None

    def start(self, job: Callable[[Tell], T], done: Callable[[T], None]) -> None:
        """Run it; `done` is called by `finish` with what it returns."""
        assert self._future is None, "one job at a time"
        self._told = told = [("", 0.0)]

        # bound to this job: one that nobody listens to any more may still be telling
        def tell(what: str, share: float) -> None:
            told[0] = (what, share)

        self._done = done
        self._future = self._worker.submit(job, tell)

    def finish(self) -> None:
        """Hand over the result when there is one; whatever the job raised is raised here."""
        future, done = self._future, self._done
        if future is None or done is None or not future.done():
            return
        self._future = self._done = None
        done(future.result())

    def forget(self) -> None:
        """A job that runs on ends for itself: nobody hears of it."""
        if self._future is not None and not self._future.done():
            self.close()
            self._worker = _worker()
        self._future = self._done = None

    def close(self) -> None:
        """No further job; returns at once."""
        self._worker.shutdown(wait=False, cancel_futures=True)


def _worker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix="wizard-job")
