"""Of the pictures of a node so many a second are looked at, however many it sends."""

import numpy as np
import pytest

from mocapd.capture.remote.arrival_limit import ArrivalLimit

S = 1_000_000_000


def taken(limit: ArrivalLimit, arrivals_ns: list[int]) -> int:
    return sum(limit.take(at_ns) for at_ns in arrivals_ns)


@pytest.mark.parametrize("rate_hz", [100, 300, 3000, 100_000])
def test_no_more_than_the_limit_is_taken(rate_hz: int) -> None:
    limit = ArrivalLimit(45.0)
    arrivals_ns = [k * S // rate_hz for k in range(4 * rate_hz)]
    assert taken(limit, arrivals_ns) == pytest.approx(4 * 45, abs=4)
    assert limit.dropped == len(arrivals_ns) - taken(ArrivalLimit(45.0), arrivals_ns)


def test_after_an_outage_no_more_than_a_few_come_together() -> None:
    limit = ArrivalLimit(45.0)
    assert limit.take(0)
    assert taken(limit, [3600 * S] * 1000) == 3


def test_a_camera_at_its_rate_loses_nothing_to_a_network_that_delays() -> None:
    random = np.random.default_rng(1)
    arrivals_ns = [k * S // 30 + round(random.uniform(0, 0.06) * S) for k in range(3000)]
    assert taken(ArrivalLimit(45.0), sorted(arrivals_ns)) == pytest.approx(3000, abs=30)


def test_a_network_that_stalls_now_and_then_is_no_node_that_sends_too_fast() -> None:
    """A quarter of a second each minute, for hours: the log would blame the rate at the node."""
    stalling, fast = ArrivalLimit(45.0), ArrivalLimit(45.0)
    for minute in range(180):
        for k in range(30 * 60):
            stalling.take(minute * 60 * S + max(k * S // 30, S // 4))
    assert stalling.dropped > 300
    assert not stalling.is_exceeded
    for k in range(60 * 60):
        fast.take(k * S // 60)
    assert fast.is_exceeded
