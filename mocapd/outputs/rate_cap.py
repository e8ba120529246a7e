"""Which frames are sent when they come faster than a receiver wants them."""

from mocapd.clock import NS_PER_S

_SMOOTHED = 8  # intervals that the estimate of the frames' own is drawn from, roughly


class RateCap:
    """Takes the frames that come nearest to a grid of times, so that frames at the cap's own rate are all taken though each
    comes some milliseconds early or late, and of faster ones every second or third, evenly.
    """

    def __init__(self, rate_hz: float) -> None:
        self._period_ns = NS_PER_S / rate_hz
        self._interval_ns = self._period_ns  # between frames as they come, smoothed
        self._last_ns: int | None = None
        self._due_ns = 0.0

    def takes(self, now_ns: int) -> bool:
        """Whether the frame that came now is to be sent; call it for each frame, with times that never decrease."""
        if self._last_ns is not None:
            interval_ns = min(now_ns - self._last_ns, self._period_ns)  # a pause is no rate
            self._interval_ns += (interval_ns - self._interval_ns) / _SMOOTHED
        self._last_ns = now_ns
        # nearest to the grid: the next frame would be farther from it
        slack_ns = self._interval_ns / 2.0
        if now_ns < self._due_ns - slack_ns:
            return False
        # the grid stays as it is while frames jitter about it, and follows one that comes later than that
        self._due_ns = max(self._due_ns, now_ns - slack_ns) + self._period_ns
        return True
