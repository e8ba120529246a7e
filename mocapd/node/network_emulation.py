"""Emulates a bad network and clock of a node, for tests and load measurements on one machine.

The option `--imperfect` of `mocapd camera-node` enables it.
"""

import random
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, fields

from mocapd.boundary.numbers import finite_number
from mocapd.clock import NS_PER_S, monotonic_ns, nanoseconds, seconds
from mocapd.errors import MalformedError, UsageError

_MOST_WAITING = 1024  # messages in transit


@dataclass(frozen=True, slots=True)
class Imperfections:
    """offset_s, drift_ppm: of the node's clock against this machine's; jitter_ms: largest delay of a message; loss: share
    of lost messages."""

    offset_s: float = 0.0
    drift_ppm: float = 0.0
    jitter_ms: float = 0.0
    loss: float = 0.0

    def node_ns(self, local_ns: int) -> int:
        """The node's time at local_ns of this machine's clock [ns]."""
        return local_ns + nanoseconds(self.offset_s) + round(local_ns * self.drift_ppm * 1e-6)


_LIMITS = {"offset_s": 1e6, "drift_ppm": 1e3, "jitter_ms": 1e3, "loss": 1.0}


def parse_imperfections(text: str) -> Imperfections:
    """`offset_s=3,drift_ppm=50`. Raises UsageError."""
    names = [key.name for key in fields(Imperfections)]
    given: dict[str, float] = {}
    for part in filter(None, text.split(",")):
        name, _, value = part.partition("=")
        most = _LIMITS.get(name, 0.0)
        low = -most if name in ("offset_s", "drift_ppm") else 0.0
        try:
            given[name] = finite_number(float(value), low, most)
        except (ValueError, MalformedError):
            name = ""
        if name not in names:
            raise UsageError(
                f"{part[:80]!r} is not understood",
                "--imperfect",
                f"write NAME=NUMBER of {', '.join(names)}",
            ) from None
    return Imperfections(**given)


class NetworkLink:
    """Passes the node's messages without delay or loss: a real network has its own."""

    def send(self, act: Callable[[], None]) -> None:
        """Runs `act` when the message arrives. Thread-safe."""
        act()

    def close(self) -> None:
        """Drops messages in transit."""


class LossyLink(NetworkLink):
    """Delays and loses messages, in order, as one connection does."""

    def __init__(self, imperfections: Imperfections) -> None:
        self._jitter_ns = nanoseconds(imperfections.jitter_ms * 1e-3)
        self._loss = imperfections.loss
        self._random = random.Random(1)
        self._changed = threading.Condition()  # guards what follows
        self._waiting: deque[tuple[int, Callable[[], None]]] = deque()
        self._last_ns = 0
        self._closed = False
        self._thread = threading.Thread(target=self._run, name="lossy-link", daemon=True)
        self._thread.start()

    def send(self, act: Callable[[], None]) -> None:
        """See NetworkLink."""
        with self._changed:
            if self._random.random() < self._loss or len(self._waiting) >= _MOST_WAITING:
                return
            late_ns = round(self._random.random() * self._jitter_ns)
            due_ns = self._last_ns = max(self._last_ns, monotonic_ns() + late_ns)
            self._waiting.append((due_ns, act))
            self._changed.notify()

    def close(self) -> None:
        """See NetworkLink."""
        with self._changed:
            self._closed = True
            self._waiting.clear()
            self._changed.notify()
        self._thread.join(0.2)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or bool(self._waiting))
                if self._closed:
                    return
                wait_ns = self._waiting[0][0] - monotonic_ns()
                if wait_ns > 0:
                    self._changed.wait(seconds(min(wait_ns, NS_PER_S)))
                    continue
                act = self._waiting.popleft()[1]
            act()
