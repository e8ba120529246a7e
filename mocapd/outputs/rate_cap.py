"""Limits the rate of frames to a receiver."""

from mocapd.clock import NS_PER_S

_SMOOTHED = 8  # frame intervals in the exponential average, roughly


class RateCap:
    """Passes the frames nearest to a grid of times. Frames at the cap's own rate all pass in spite of some milliseconds
    of jitter; of faster ones every second or third passes, evenly.
    """

    def __init__(self, rate_hz: float) -> None:
        self._period_ns = NS_PER_S / rate_hz
        self._interval_ns = self._period_ns  # of the incoming frames, smoothed
        self._last_ns: int | None = None
        self._due_ns = 0.0

    def takes(self, now_ns: int) -> bool:
        """True if this frame is to be sent. Call it for each frame, with times that never decrease."""
        if self._last_ns is not None:
            interval_ns = min(now_ns - self._last_ns, self._period_ns)  # ignores pauses
            self._interval_ns += (interval_ns - self._interval_ns) / _SMOOTHED
        self._last_ns = now_ns
        # within half an interval, this frame is nearer to the grid time than the next one
        slack_ns = self._interval_ns / 2.0
        if now_ns < self._due_ns - slack_ns:
            return False
        # the grid stays while frames jitter about it, and shifts for a later frame
        self._due_ns = max(self._due_ns, now_ns - slack_ns) + self._period_ns
        return True
