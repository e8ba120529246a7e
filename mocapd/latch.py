"""One-shot events that threads wait for, and that a thread or a signal handler sets."""

from contextlib import suppress
from threading import Lock

from mocapd.errors import MocapdError


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


class ThreadDiedError(RuntimeError):
    """A thread ended unexpectedly; the exception that ended it is the `__cause__`."""


class EndLatch(Latch):
    """A latch that an exception of another thread sets, too; it is raised where the owner waits."""

    def __init__(self) -> None:
        super().__init__()
        self._death: BaseException | None = None

    def died(self, error: BaseException) -> None:
        """Sets it after the unexpected end of a thread, the first of which is raised; thread-safe."""
        self._death = self._death or error
        self.set()

    def wait(self, timeout_s: float) -> bool:
        """See Latch. Raises the MocapdError that ended a thread, ThreadDiedError for anything else."""
        is_set = super().wait(timeout_s)
        if isinstance(self._death, MocapdError):
            raise self._death
        if self._death is not None:
            raise ThreadDiedError from self._death
        return is_set
