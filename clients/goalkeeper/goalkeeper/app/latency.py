"""How late the screen is: from the exposure of a picture to its first showing. Pure."""

from collections import deque
from statistics import median

_KEPT = 60  # sightings: two seconds at 30 Hz


class Latency:
    """Of the newest sightings."""

    def __init__(self) -> None:
        self._newest_s: float | None = None
        self._kept_s: deque[float] = deque(maxlen=_KEPT)

    def shown(self, captured_s: float | None, now_s: float) -> None:
        """A picture is on the screen at now_s; its newest sighting was captured then. Each counts once."""
        if captured_s is not None and captured_s != self._newest_s:
            self._newest_s = captured_s
            self._kept_s.append(now_s - captured_s)

    @property
    def median_s(self) -> float | None:
        """None: nothing was seen yet."""
        return median(self._kept_s) if self._kept_s else None
