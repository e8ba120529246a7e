"""Threads that wait until the configuration has been read again by the one that does it."""

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
    """`ask` is called by any thread and waits; everything else by the owner of the session.

    What is read is read after somebody asked: who asks while another reading is under way waits for the next one.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._asking: list[_Wish] = []
        self._under_way: list[_Wish] = []
        self._closed = False

    def ask(self) -> Reloaded:
        """Returns when it has been taken up. Raises the MocapdError for which it was refused."""
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
        """Whether somebody asks; a reading that begins now is for them."""
        with self._lock:
            self._under_way += self._asking
            self._asking = []
            return bool(self._under_way)

    def settle(self, outcome: Reloaded | MocapdError) -> None:
        """The reading that was begun has come to this end."""
        with self._lock:
            done, self._under_way = self._under_way, []
        for wish in done:
            if isinstance(outcome, MocapdError):
                wish.refused = outcome
            else:
                wish.reloaded = outcome
            wish.settled.set()

    def close(self) -> None:
        """Nothing is taken up any more."""
        with self._lock:
            self._closed = True
        self.take()
        self.settle(_ending())


def _ending() -> UnavailableError:
    return UnavailableError("it is ending", "the daemon", "start it anew")
