"""Token bucket that limits the pictures per second of one camera node. Pure: the caller passes the time."""

from mocapd.clock import NS_PER_S

_BURST = 3.0  # bucket size [pictures]: networks delay some and then deliver them together
# Dropped pictures by which a node sends too fast. A network that stalls now and then has some dropped each time.
_MANY_DROPPED, _WITHIN_NS = 300, 60 * NS_PER_S


class ArrivalLimit:
    """`dropped` counts arrivals above the limit; `is_exceeded`: lastingly, not by a network that delivers in bursts."""

    def __init__(self, most_hz: float) -> None:
        """most_hz: above 0."""
        self.most_hz = most_hz
        self.dropped = 0
        self.is_exceeded = False
        self._tokens = _BURST
        self._at_ns: int | None = None
        self._counted_ns = self._counted = 0  # start of the current count of dropped ones, and that

    def take(self, now_ns: int) -> bool:
        """True if an arrival at `now_ns` is within the limit; `now_ns` must not decrease."""
        if self._at_ns is not None:
            self._tokens += (now_ns - self._at_ns) * self.most_hz / NS_PER_S
        self._at_ns = now_ns
        self._tokens = min(self._tokens, _BURST)
        if self._tokens < 1.0:
            self.dropped += 1
            self._judge(now_ns)
            return False
        self._tokens -= 1.0
        return True

    def _judge(self, now_ns: int) -> None:
        if now_ns - self._counted_ns > _WITHIN_NS:
            self._counted_ns, self._counted = now_ns, 0
        self._counted += 1
        self.is_exceeded |= self._counted >= _MANY_DROPPED
