"""How many pictures a second of one camera node are looked at, by the time of their arrival. Pure: no clock."""

from mocapd.clock import NS_PER_S

_BURST = (
    3.0  # pictures that may come together: networks hold some up, and then deliver them at once
)


class ArrivalLimit:
    """A token bucket. `dropped`: arrivals that were over the limit."""

    def __init__(self, most_hz: float) -> None:
        """most_hz: above 0."""
        self.most_hz = most_hz
        self.dropped = 0
        self._tokens = _BURST
        self._at_ns: int | None = None

    def take(self, now_ns: int) -> bool:
        """Whether one that arrives now is within the limit; `now_ns` never decreases."""
        if self._at_ns is not None:
            self._tokens += (now_ns - self._at_ns) * self.most_hz / NS_PER_S
        self._at_ns = now_ns
        self._tokens = min(self._tokens, _BURST)
        if self._tokens < 1.0:
            self.dropped += 1
            return False
        self._tokens -= 1.0
        return True
