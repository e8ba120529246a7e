"""Latencies are counted in the bucket they belong to, and those of sessions before are added."""

from mocapd.pipeline.latency_histogram import BOUNDS_MS, LatencyCounts, LatencyHistogram


def test_each_is_counted_once_up_to_its_bound() -> None:
    histogram = LatencyHistogram()
    for latency_ms in (1.0, BOUNDS_MS[0], BOUNDS_MS[0] + 0.1, BOUNDS_MS[-1] + 1.0):
        histogram.add(latency_ms)
    found = histogram.counts()
    assert (found.counts[0], found.counts[1], found.counts[-1]) == (2, 1, 1)
    assert sum(found.counts) == 4
    assert found.sum_ms == 1.0 + 2 * BOUNDS_MS[0] + 0.1 + BOUNDS_MS[-1] + 1.0
    histogram.add(1.0)
    assert sum(found.counts) == 4


def test_sessions_add_up() -> None:
    one = LatencyHistogram()
    one.add(7.0)
    both = one.counts() + one.counts() + LatencyCounts()
    assert both.counts[1] == 2
    assert both.sum_ms == 14.0
