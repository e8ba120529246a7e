"""How much of the last steps a coming one is."""

import numpy as np
import pytest

from mocapd.outputs.prediction.extrapolation_weights import step_weights

RATES_HZ = (15.0, 30.0, 60.0, 90.0)


def moved(ages_s: list[float], ahead_s: float, x: np.ndarray) -> float:
    """What is predicted of a value x at these ages, newest first."""
    return float(np.dot(step_weights(ages_s, ahead_s), x[:-1] - x[1:]))


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_a_steady_motion_goes_on_most_of_the_way(rate_hz: float) -> None:
    ages_s = [k / rate_hz for k in range(int(0.14 * rate_hz) + 1)]
    for ahead_s in (0.016, 0.033, 0.05, 0.1):
        share = moved(ages_s, ahead_s, -np.array(ages_s)) / ahead_s
        assert 0.68 < share < 0.9
    near, far = (moved(ages_s, a, -np.array(ages_s)) / a for a in (0.01, 0.1))
    assert near > far  # people stop


def test_who_speeds_up_goes_farther() -> None:
    ages_s = [k / 30.0 for k in range(5)]
    t = -np.array(ages_s)
    assert moved(ages_s, 0.05, t + 2.0 * t**2) > moved(ages_s, 0.05, t)
    assert moved(ages_s, 0.05, t - 2.0 * t**2) < moved(ages_s, 0.05, t)


def test_frames_need_not_come_evenly() -> None:
    even = [k / 30.0 for k in range(5)]
    uneven = [0.0, 0.02, 0.07, 0.1, 0.13]
    for ages_s in (even, uneven):
        t = -np.array(ages_s)
        assert moved(ages_s, 0.033, t + t**2) == pytest.approx(
            moved(even, 0.033, -np.array(even) + np.array(even) ** 2), rel=1e-9
        )


def test_nothing_is_known_of_a_single_frame() -> None:
    assert step_weights([0.0], 0.05) == []
    assert moved([0.0, 0.033, 0.066], 0.0, np.array([3.0, 2.0, 1.0])) == 0.0
