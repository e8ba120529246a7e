"""Histogram of all latencies since the start, which percentiles of the last ten seconds do not show."""

from bisect import bisect_left
from dataclasses import dataclass

BOUNDS_MS = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 75.0, 100.0, 150.0, 200.0, 300.0, 500.0, 1000.0)  # fmt: skip


@dataclass(frozen=True, slots=True)
class LatencyCounts:
    """counts: of latencies in each bin, from the previous bound (exclusive) to each of BOUNDS_MS; the last bin is open."""

    counts: tuple[int, ...] = (0,) * (len(BOUNDS_MS) + 1)
    sum_ms: float = 0.0

    def __add__(self, other: "LatencyCounts") -> "LatencyCounts":
        counts = tuple(a + b for a, b in zip(self.counts, other.counts, strict=True))
        return LatencyCounts(counts, self.sum_ms + other.sum_ms)


class LatencyHistogram:
    """Not thread-safe."""

    def __init__(self) -> None:
        self._counts = [0] * (len(BOUNDS_MS) + 1)
        self._sum_ms = 0.0

    def add(self, latency_ms: float) -> None:
        """Count one frame's latency."""
        self._counts[bisect_left(BOUNDS_MS, latency_ms)] += 1
        self._sum_ms += latency_ms

    def counts(self) -> LatencyCounts:
        """A copy."""
        return LatencyCounts(tuple(self._counts), self._sum_ms)
