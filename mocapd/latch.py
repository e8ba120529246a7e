"""What is over once and for all: waited for by threads, told by any of them or by a signal handler."""

from queue import Empty, SimpleQueue


class Latch:
    """A `threading.Event` that a signal handler may set: that one takes a lock which the interrupted thread holds each time
    that it begins to wait or ends, and then both wait for ever. `SimpleQueue.put` may interrupt `get`."""

    def __init__(self) -> None:
        self._is_set = False
        self._woken: SimpleQueue[None] = SimpleQueue()

    def is_set(self) -> bool:
        """Whether it was told."""
        return self._is_set

    def set(self) -> None:
        """Tell it; from any thread or a signal handler, as often as one likes."""
        self._is_set = True
        self._woken.put(None)

    def wait(self, timeout_s: float) -> bool:
        """Whether it was told, at most timeout_s from now."""
        if not self._is_set:
            try:
                self._woken.get(timeout=max(timeout_s, 0.0))
            except Empty:
                return self._is_set
            self._woken.put(None)  # others may wait, too
        return self._is_set
