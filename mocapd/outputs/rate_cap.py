"""Lets so many frames a second through, evenly, whatever the rate at which they come."""

from mocapd.clock import NS_PER_S

_EARLY = (
    0.25  # how far before its time a frame may come, as cameras and schedulers jitter [periods]
)


class RateCap:
    """For one thread. Frames that come at the rate itself, unevenly, all get through."""

    def __init__(self, rate_hz: float) -> None:
        self._period_ns = round(NS_PER_S / rate_hz)
        self._next_ns: int | None = None

    def lets_through(self, now_ns: int) -> bool:
        """Whether a frame of this time is sent; asked once a frame."""
        due_ns = self._next_ns
        if due_ns is not None and now_ns < due_ns - _EARLY * self._period_ns:
            return False
        # on the beat that there was; after a pause on another one
        if due_ns is None or now_ns >= due_ns + self._period_ns:
            due_ns = now_ns
        self._next_ns = due_ns + self._period_ns
        return True
