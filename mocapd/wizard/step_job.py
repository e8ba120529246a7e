"""The single job of a step, in a thread of its own; leaving the step drops its result."""

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
        self._report: list[tuple[str, float]] = []  # of the running job; each job has its own

    @property
    def progress(self) -> tuple[str, float] | None:
        """The job's task and progress 0..1; None without one."""
        return self._report[0] if self._future is not None else None

    def start(self, job: Callable[[Tell], T], done: Callable[[T], None]) -> None:
        """Run it; `finish` passes its result to `done`."""
        assert self._future is None, "one job at a time"
        self._report = latest = [("", 0.0)]

        # local to this job: a dropped one may still report
        def report(what: str, share: float) -> None:
            latest[0] = (what, share)

        self._done = done
        self._future = self._worker.submit(job, report)

    def finish(self) -> None:
        """Pass on the result, if there is one; re-raises the job's exception."""
        future, done = self._future, self._done
        if future is None or done is None or not future.done():
            return
        self._future = self._done = None
        done(future.result())

    def forget(self) -> None:
        """Drop the job's result; a running job ends by itself."""
        if self._future is not None and not self._future.done():
            self.close()
            self._worker = _worker()
        self._future = self._done = None

    def close(self) -> None:
        """No further job; returns at once."""
        self._worker.shutdown(wait=False, cancel_futures=True)


def _worker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix="wizard-job")
