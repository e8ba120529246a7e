"""Rates and percentiles over the recent past."""

import math

import pytest

from mocapd.pipeline.rolling import RollingPercentiles, RollingRate, percentiles

SECOND = 1_000_000_000


def test_a_steady_stream_has_its_rate_and_silence_lowers_it_to_nothing() -> None:
    rate = RollingRate(2.0)
    last_ns = 0
    for k in range(90):
        last_ns = k * SECOND // 30
        rate.add(last_ns)
    assert rate.rate_hz(last_ns) == pytest.approx(30.0)
    assert rate.rate_hz(last_ns + SECOND // 60) == pytest.approx(30.0, rel=1e-6)
    assert 10.0 < rate.rate_hz(last_ns + SECOND) < 22.0
    assert rate.rate_hz(last_ns + 3 * SECOND) == 0.0


def test_too_few_events_have_no_rate() -> None:
    rate = RollingRate()
    assert rate.rate_hz(0) == 0.0
    rate.add(0)
    assert rate.rate_hz(0) == 0.0


def test_percentiles_are_of_the_newest_samples() -> None:
    rolling = RollingPercentiles(100)
    for sample in range(1_000):
        rolling.add(float(sample))
    got = percentiles(rolling.samples())
    assert got.median == pytest.approx(949.5)
    assert got.p95 == pytest.approx(994.05)
    assert math.isnan(percentiles(()).median)
