"""Calls into Zenoh that the interpreter's exit waits for: a thread that came back later would abort it."""

import atexit
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_LONGEST_S = 5.0  # that the exit waits; what is called takes less once its session is closed


class _Calls:
    """Those under way, in all threads."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._under_way, self._over = 0, False

    @contextmanager
    def one(self) -> Iterator[None]:
        """Around a call. While the interpreter exits only the main thread gets that far."""
        with self._changed:
            self._changed.wait_for(self._may_begin)
            self._under_way += 1
        try:
            yield
        finally:
            with self._changed:
                self._under_way -= 1
                self._changed.notify_all()

    def end(self) -> None:
        """Wait for those under way."""
        with self._changed:
            self._over = True
            self._changed.wait_for(lambda: self._under_way == 0, _LONGEST_S)

    def _may_begin(self) -> bool:
        return not self._over or threading.current_thread() is threading.main_thread()


_CALLS = _Calls()
atexit.register(_CALLS.end)  # before any session is open, so that it comes after their closing

zenoh_call = _CALLS.one
