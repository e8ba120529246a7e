"""An event loop that never waits for the time: when nothing is to be done, it is later at once."""

import asyncio
import selectors
from collections.abc import Callable
from concurrent.futures import Executor
from typing import Any


class _Selector(selectors.DefaultSelector):
    def __init__(self) -> None:
        super().__init__()
        self.skipped_s = 0.0
        self.at_work = 0  # calls in other threads, which do take their time

    def select(self, timeout: float | None = None) -> list[Any]:
        """The descriptors that are ready; the clock jumps by `timeout` when there is none."""
        if timeout is None or timeout <= 0.0:
            return super().select(timeout)
        ready = super().select(0.001 if self.at_work else 0.0)
        if not ready:
            self.skipped_s += timeout
        return ready


class WarpLoop(asyncio.SelectorEventLoop):
    """See the module."""

    def __init__(self) -> None:
        self._own = _Selector()
        super().__init__(self._own)

    def time(self) -> float:
        """Seconds, with those that were not waited for."""
        return super().time() + self._own.skipped_s

    def run_in_executor(  # type: ignore[override]  # typeshed's has type variables of its own
        self, executor: Executor | None, func: Callable[..., Any], *args: Any
    ) -> "asyncio.Future[Any]":
        """See asyncio."""
        future = super().run_in_executor(executor, func, *args)
        self._own.at_work += 1
        future.add_done_callback(self._ended)
        return future

    def _ended(self, _future: "asyncio.Future[Any]") -> None:
        self._own.at_work -= 1
