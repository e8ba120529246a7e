"""A one-shot event that threads wait for, and that a thread or a signal handler sets."""

from contextlib import suppress
from threading import Lock


class Latch:
    """A `threading.Event` that a signal handler may set.

    `Event.set` takes a lock that the interrupted thread may hold in `wait`: a deadlock. A bare lock's `release` may
    interrupt its `acquire`, which also keeps its timeout when a signal arrives as it expires, unlike `SimpleQueue.get`
    (CPython 3.11)."""

    def __init__(self) -> None:
        self._is_set = False
        self._closed = Lock()
        self._closed.acquire()

    def is_set(self) -> bool:
        """True after `set`."""
        return self._is_set

    def set(self) -> None:
        """Sets it; thread-safe, signal-safe, idempotent."""
        self._is_set = True
        self._release()

    def wait(self, timeout_s: float) -> bool:
        """Waits at most timeout_s [s]; True if it is set."""
        if not self._is_set and self._closed.acquire(timeout=max(timeout_s, 0.0)):
            self._release()  # for other waiting threads
        return self._is_set

    def _release(self) -> None:
        with suppress(RuntimeError):  # another thread or a handler was first
            self._closed.release()
