"""What is over once and for all: waited for by threads, told by any of them or by a signal handler."""

from contextlib import suppress
from threading import Lock


class Latch:
    """A `threading.Event` that a signal handler may set: that one takes a lock which the interrupted thread holds each time
    that it begins to wait or ends, and then both wait for ever. A bare lock's `release` may interrupt its `acquire`; nor does
    that forget its timeout when a signal comes as it runs out, as `SimpleQueue.get` does (CPython 3.11)."""

    def __init__(self) -> None:
        self._is_set = False
        self._closed = Lock()
        self._closed.acquire()

    def is_set(self) -> bool:
        """Whether it was told."""
        return self._is_set

    def set(self) -> None:
        """Tell it; from any thread or a signal handler, as often as one likes."""
        self._is_set = True
        self._open()

    def wait(self, timeout_s: float) -> bool:
        """Whether it was told, at most timeout_s from now."""
        if not self._is_set and self._closed.acquire(timeout=max(timeout_s, 0.0)):
            self._open()  # others may wait, too
        return self._is_set

    def _open(self) -> None:
        with suppress(RuntimeError):  # another thread or a handler was first
            self._closed.release()
