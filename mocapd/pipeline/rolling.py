"""Statistics of the recent past: a rate over a time window, percentiles over a number of samples."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from mocapd.clock import NS_PER_S


@dataclass(frozen=True, slots=True)
class Percentiles:
    """Of the stored samples, in their unit; NaN before the first."""

    median: float
    p95: float


class RollingPercentiles:
    """The last `size` samples. Not thread-safe."""

    def __init__(self, size: int = 300) -> None:
        self._samples: deque[float] = deque(maxlen=size)

    def add(self, sample: float) -> None:
        self._samples.append(sample)

    def samples(self) -> tuple[float, ...]:
        """A copy, so that the sorting happens outside any lock."""
        return tuple(self._samples)


def percentiles(samples: tuple[float, ...]) -> Percentiles:
    """Median and 95th percentile."""
    if not samples:
        return Percentiles(float("nan"), float("nan"))
    median, p95 = np.percentile(samples, (50.0, 95.0))
    return Percentiles(float(median), float(p95))


class RollingRate:
    """Events per second over the last `window_s` [s]; falls to 0 without events. Not thread-safe."""

    def __init__(self, window_s: float = 2.0) -> None:
        self._window_ns = round(window_s * NS_PER_S)
        self._times_ns: deque[int] = deque()

    def add(self, now_ns: int) -> None:
        """Count an event at `now_ns`."""
        self._times_ns.append(now_ns)
        self._forget(now_ns)

    def rate_hz(self, now_ns: int) -> float:
        """Intervals per second between the stored events; a pause longer than them lowers it."""
        self._forget(now_ns)
        n = len(self._times_ns)
        if n < 2:
            return 0.0
        first_ns, last_ns = self._times_ns[0], self._times_ns[-1]
        interval_ns = (last_ns - first_ns) / (n - 1)
        # within one mean interval after the last event no event is overdue
        span_ns = max(last_ns, now_ns - interval_ns) - first_ns
        return (n - 1) * NS_PER_S / span_ns if span_ns > 0 else 0.0

    def _forget(self, now_ns: int) -> None:
        while self._times_ns and now_ns - self._times_ns[0] > self._window_ns:
            self._times_ns.popleft()
