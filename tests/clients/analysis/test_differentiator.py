"""Derivatives of motions whose derivatives are known."""

import numpy as np
import pytest

from mocapd_analysis.accuracy.tracker_noise import TRACKED, draw
from mocapd_analysis.differentiator import ACCELERATION, SPEED, Smoothing, derivatives, peak

T = np.arange(0.0, 3.0, 1.0 / 60.0)


@pytest.mark.parametrize("smoothing", [SPEED, ACCELERATION])
def test_a_cubic_comes_out_exactly_up_to_the_ends(smoothing: Smoothing) -> None:
    value, first, second = derivatives(T, 2.0 * T**3 - T, smoothing)
    np.testing.assert_allclose(value, 2.0 * T**3 - T, atol=1e-8)
    np.testing.assert_allclose(first, 6.0 * T**2 - 1.0, atol=1e-7)
    np.testing.assert_allclose(second, 12.0 * T, atol=1e-5)


def test_irregular_times_need_no_resampling() -> None:
    random = np.random.default_rng(3)
    times_s = np.sort(T + random.uniform(-0.004, 0.004, len(T)))
    times_s = np.delete(times_s, [20, 21, 60, 90])  # lost frames, no gap
    _, first, _ = derivatives(times_s, np.stack([times_s**3, -times_s], axis=1), SPEED)
    np.testing.assert_allclose(first[:, 0], 3.0 * times_s**2, atol=1e-6)
    np.testing.assert_allclose(first[:, 1], -1.0, atol=1e-7)


def test_nothing_is_fitted_across_a_gap() -> None:
    times_s = np.concatenate([T[:60], T[:60] + 5.0])
    values = np.concatenate([np.zeros(60), np.full(60, 3.0)])
    _, first, _ = derivatives(times_s, values, SPEED)
    np.testing.assert_allclose(first, 0.0, atol=1e-9)


def test_a_run_too_short_to_tell_is_nan() -> None:
    times_s = np.array([0.0, 0.02, 0.04, 5.0])
    assert np.isnan(derivatives(times_s, times_s, SPEED)[1]).all()


@pytest.mark.parametrize("rate_hz", [30.0, 60.0, 120.0])
def test_a_fast_swing_keeps_its_speed(rate_hz: float) -> None:
    """4 Hz is a fast throw: half a period there and back is an eighth of a second."""
    times_s = np.arange(0.0, 2.0, 1.0 / rate_hz)
    _, first, _ = derivatives(times_s, np.sin(2 * np.pi * 4.0 * times_s), SPEED)
    inner = first[15:-15]
    assert np.abs(inner).max() == pytest.approx(2 * np.pi * 4.0, rel=0.025)


def test_noise_of_a_tracker_leaves_the_peak_within_five_percent() -> None:
    """A swing of 5 m/s at 30 Hz, as its median over many draws: no test may need luck."""
    times_s = np.arange(0.0, 4.0, 1.0 / 30.0)
    way_m = np.zeros((len(times_s), 3))
    way_m[:, 0] = 0.4 * np.tanh((times_s - 2.0) / 0.08)
    truth = 0.4 / 0.08
    found = []
    for seed in range(20):
        noisy = way_m + draw(TRACKED, len(times_s), 30.0, np.random.default_rng(seed))
        speed = np.linalg.norm(derivatives(times_s, noisy, SPEED)[1], axis=1)
        found.append(peak(times_s, speed, int(speed.argmax()))[1])
    assert np.median(np.abs(np.array(found) / truth - 1.0)) < 0.05


def test_a_peak_between_frames_is_found_there() -> None:
    times_s = np.array([0.0, 0.1, 0.2, 0.3])
    at_s, value = peak(times_s, 5.0 - (times_s - 0.13) ** 2, 1)
    assert (at_s, value) == pytest.approx((0.13, 5.0))
    assert peak(times_s, times_s, 3) == pytest.approx((0.3, 0.3))  # an end stays one
