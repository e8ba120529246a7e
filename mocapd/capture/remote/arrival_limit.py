"""Token bucket that limits the pictures per second of one camera node. Pure: the caller passes the time."""

from mocapd.clock import NS_PER_S

_BURST = 3.0  # bucket size [pictures]: networks delay some and then deliver them together


class ArrivalLimit:
    """`dropped` counts arrivals above the limit."""

    def __init__(self, most_hz: float) -> None:
        """most_hz: above 0."""
        self.most_hz = most_hz
        self.dropped = 0
        self._tokens = _BURST
        self._at_ns: int | None = None

    def take(self, now_ns: int) -> bool:
        """True if an arrival at `now_ns` is within the limit; `now_ns` must not decrease."""
        if self._at_ns is not None:
            self._tokens += (now_ns - self._at_ns) * self.most_hz / NS_PER_S
        self._at_ns = now_ns
        self._tokens = min(self._tokens, _BURST)
        if self._tokens < 1.0:
            self.dropped += 1
            return False
        self._tokens -= 1.0
        return True
