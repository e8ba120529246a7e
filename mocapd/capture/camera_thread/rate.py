"""Frame rate over a sliding window of the frames' time stamps."""

from collections import deque

from mocapd.clock import NS_PER_S

_MOST = 4096  # frames remembered, whatever their stamps say


class RateMeter:
    """Frames per second over the last `window_s` [s]. Not thread-safe."""

    def __init__(self, window_s: float = 2.0) -> None:
        self._window_ns = round(window_s * NS_PER_S)
        self._times_ns: deque[int] = deque(maxlen=_MOST)

    def clear(self) -> None:
        """Empties the window: the gap before a reopening must not count as a low rate."""
        self._times_ns.clear()

    def add(self, t_ns: int) -> None:
        """Adds a frame with time `t_ns` [ns]."""
        self._times_ns.append(t_ns)
        while t_ns - self._times_ns[0] > self._window_ns:
            self._times_ns.popleft()

    @property
    def full(self) -> bool:
        """True once the window is three quarters full: the rate is then reliable."""
        return self._span_ns() >= 0.75 * self._window_ns

    def rate_hz(self, silent_ns: int = 0) -> float:
        """The mean rate in the window [Hz]; 0 before the second frame.

        silent_ns: time since the last frame arrived. The part beyond the mean interval lowers the rate; after a
        whole window of silence the rate is 0.
        """
        span_ns, intervals = self._span_ns(), len(self._times_ns) - 1
        if span_ns <= 0 or silent_ns > self._window_ns:
            return 0.0
        return intervals * NS_PER_S / (span_ns + max(0, silent_ns - span_ns // intervals))

    def _span_ns(self) -> int:
        return self._times_ns[-1] - self._times_ns[0] if self._times_ns else 0
