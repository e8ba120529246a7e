"""Queue of reload requests: threads wait until the owner has reloaded the configuration."""

import threading
from dataclasses import dataclass, field

from mocapd.control.control_messages import Reloaded
from mocapd.errors import MocapdError, UnavailableError


@dataclass(slots=True, eq=False)
class _Wish:
    settled: threading.Event = field(default_factory=threading.Event)
    reloaded: Reloaded | None = None
    refused: MocapdError | None = None


class Reloads:
    """Any thread calls `ask`, which waits; the session's owner calls the rest.

    A reload starts after its request: a request during a reload waits for the next one.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._asking: list[_Wish] = []
        self._under_way: list[_Wish] = []
        self._closed = False

    def ask(self) -> Reloaded:
        """Requests a reload and waits for it. Raises the MocapdError of a refusal."""
        wish = _Wish()
        with self._lock:
            if self._closed:
                raise _ending()
            self._asking.append(wish)
        wish.settled.wait()
        if wish.reloaded is None:
            raise wish.refused or _ending()
        return wish.reloaded

    def take(self) -> bool:
        """True if requests wait; a reload that starts now answers them."""
        with self._lock:
            self._under_way += self._asking
            self._asking = []
            return bool(self._under_way)

    def settle(self, outcome: Reloaded | MocapdError) -> None:
        """Reports the outcome of the current reload."""
        with self._lock:
            done, self._under_way = self._under_way, []
        for wish in done:
            if isinstance(outcome, MocapdError):
                wish.refused = outcome
            else:
                wish.reloaded = outcome
            wish.settled.set()

    def close(self) -> None:
        """Refuses all waiting and later requests."""
        with self._lock:
            self._closed = True
        self.take()
        self.settle(_ending())


def _ending() -> UnavailableError:
    return UnavailableError("it is ending", "the daemon", "restart it")
