"""Weights of the last steps of a motion for its extrapolation.

Fits a parabola to the last frames by least squares. Damps the speed with the time ahead, and the acceleration
strongly: both are noisy, and people stop. The constants were chosen on 75 clips of real motion with the tracker's own
errors added; docs/prediction.md has the figures.
"""

import math
from collections.abc import Sequence

WINDOW_S = 0.14  # of the fit: five frames at 30 Hz, nine at 60 Hz [s]

_SPEED_SHARE = 0.88
_SPEED_HOLDS_S = 0.26  # time constant of the speed's decay [s]
_ACCELERATION_SHARE = 0.2
_LEAST_FOR_PARABOLA = 5  # frames


def step_weights(ages_s: Sequence[float], ahead_s: float) -> list[float]:
    """The motion from the newest frame to `ahead_s` [s] later, as weights of the steps between frames.

    ages_s (n,): of the frames, newest first, beginning with 0, strictly rising. Returns n - 1 weights; the first
    belongs to the newest step.
    """
    n = len(ages_s)
    if n < 2:
        return []
    speed, acceleration = _slopes(ages_s)
    held_s = _SPEED_HOLDS_S * (1.0 - math.exp(-ahead_s / _SPEED_HOLDS_S))
    by_speed = _SPEED_SHARE * held_s
    by_acceleration = _ACCELERATION_SHARE * ahead_s * ahead_s
    shares, sum_so_far = [], 0.0
    for k in range(n - 1):
        sum_so_far += by_speed * speed[k] + by_acceleration * acceleration[k]
        shares.append(sum_so_far)
    return shares


def _slopes(ages_s: Sequence[float]) -> tuple[list[float], list[float]]:
    """The weights (n,) of the frames' values in the first and the second coefficient of the least-squares polynomial
    in time, at the newest frame [1/s, 1/s^2]."""
    n = len(ages_s)
    times = [-age / WINDOW_S for age in ages_s]  # of the order of one, for conditioning
    s1, s2 = math.fsum(times), math.fsum(t * t for t in times)
    if n < _LEAST_FOR_PARABOLA:
        spread = n * s2 - s1 * s1
        return [(n * t - s1) / (spread * WINDOW_S) for t in times], [0.0] * n
    s3, s4 = math.fsum(t**3 for t in times), math.fsum(t**4 for t in times)
    # rows two and three of the inverse of [[n s1 s2] [s1 s2 s3] [s2 s3 s4]]
    m01, m02 = s2 * s3 - s1 * s4, s1 * s3 - s2 * s2
    m11, m12, m22 = n * s4 - s2 * s2, s1 * s2 - n * s3, n * s2 - s1 * s1
    whole = n * (s2 * s4 - s3 * s3) + s1 * m01 + s2 * m02
    first = [(m01 + m11 * t + m12 * t * t) / (whole * WINDOW_S) for t in times]
    second = [(m02 + m12 * t + m22 * t * t) / (whole * WINDOW_S**2) for t in times]
    return first, second
