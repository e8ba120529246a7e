"""The cap on the rate: a stream at its own rate passes whole, whatever the jitter; faster ones are thinned evenly."""

from itertools import pairwise

import numpy as np
import pytest

from mocapd.clock import NS_PER_S
from mocapd.outputs.rate_cap import RateCap

SECONDS = 20


def taken(rate_hz: float, cap_hz: float, jitter_s: float = 0.0, seed: int = 0) -> list[float]:
    """Times at which frames are sent [s], of frames that come so often, each early or late by at most `jitter_s`."""
    random = np.random.default_rng(seed)
    cap = RateCap(cap_hz)
    times_s = np.arange(int(SECONDS * rate_hz)) / rate_hz
    times_s += random.uniform(-jitter_s, jitter_s, len(times_s))
    return [t for t in np.sort(times_s).tolist() if cap.takes(round(t * NS_PER_S))]


@pytest.mark.parametrize("rate_hz", [30.0, 59.94, 60.0])
@pytest.mark.parametrize("jitter_s", [0.0, 0.001, 0.003])
@pytest.mark.parametrize("seed", range(3))
def test_frames_at_the_caps_own_rate_are_all_sent(
    rate_hz: float, jitter_s: float, seed: int
) -> None:
    assert len(taken(rate_hz, 60.0, jitter_s, seed)) == int(SECONDS * rate_hz)


def test_a_camera_that_is_a_little_too_fast_loses_single_frames_now_and_then() -> None:
    times_s = taken(60.3, 60.0)
    assert len(times_s) == pytest.approx(SECONDS * 60.0, abs=2)
    assert max(b - a for a, b in pairwise(times_s)) < 2.01 / 60.3


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("rate_hz", "every"), [(120.0, 2), (180.0, 3), (90.0, 3)])
def test_faster_frames_are_thinned_evenly(rate_hz: float, every: int, seed: int) -> None:
    cap_hz = 30.0 if rate_hz == 90.0 else 60.0
    times_s = taken(rate_hz, cap_hz, jitter_s=0.1 / rate_hz, seed=seed)
    gaps_s = np.diff(times_s)
    assert len(times_s) == pytest.approx(SECONDS * cap_hz, abs=3)
    assert gaps_s[5:].min() > (every - 0.25) / rate_hz
    assert gaps_s[5:].max() < (every + 0.25) / rate_hz


@pytest.mark.parametrize("rate_hz", [75.0, 90.0, 144.0, 240.0])
def test_the_cap_is_kept_over_time(rate_hz: float) -> None:
    sent = len(taken(rate_hz, 60.0, jitter_s=0.002))
    assert 0.99 * SECONDS * 60.0 <= sent <= SECONDS * 60.0 + 1


def test_after_a_pause_frames_go_on_at_once() -> None:
    cap = RateCap(60.0)
    at_ns = [0, NS_PER_S // 60, 100 * NS_PER_S, 100 * NS_PER_S + NS_PER_S // 60]
    assert [cap.takes(t) for t in at_ns] == [True] * 4


def test_two_frames_at_once_are_one() -> None:
    cap = RateCap(60.0)
    assert [cap.takes(0), cap.takes(0), cap.takes(1)] == [True, False, False]
