"""How right accelerations are: far less than speeds, whatever window they are taken by."""

from collections.abc import Iterator, Sequence

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.accuracy.clips import Course
from mocapd_analysis.accuracy.tracker_noise import Noise, draw
from mocapd_analysis.differentiator import ACCELERATION, Smoothing, derivatives

TRIED = (
    Smoothing(0.2, 2),
    Smoothing(0.2, 4),
    ACCELERATION,
    Smoothing(0.33, 4),
    Smoothing(0.4, 4),
    Smoothing(0.27, 6),
    Smoothing(0.4, 6),
)
_END_S = 0.2


def acceleration_lines(swings: Sequence[Course], rate_hz: float, noise: Noise) -> Iterator[str]:
    """A line for each window and degree: RMS error as a share of the RMS acceleration, and error of the peak."""
    yield f"{'accelerations':24}|  RMS error    peak, mean    median |.|   [percent]"
    for smoothing in TRIED:
        random = np.random.default_rng(0)
        found = [_errors(course, rate_hz, noise, smoothing, random) for course in swings]
        error, peak = 100.0 * np.array(found).T
        chosen = " *" if smoothing is ACCELERATION else "  "
        yield (
            f"degree {smoothing.order}, {smoothing.window_s:.2f} s{'':6}{chosen}| "
            f"{np.median(error):10.0f} {peak.mean():+13.0f} {np.median(np.abs(peak)):13.0f}"
        )


def _errors(
    course: Course,
    rate_hz: float,
    noise: Noise,
    smoothing: Smoothing,
    random: np.random.Generator,
) -> tuple[float, float]:
    times_s = np.arange(random.uniform(0.0, 1.0 / rate_hz), course.end_s, 1.0 / rate_hz)
    places_m = course.way_m(times_s) + draw(noise, len(times_s), rate_hz, random)
    inner = (times_s > _END_S) & (times_s < course.end_s - _END_S)
    truth: Floats = course.way_m.derivative(2)(times_s)[inner]
    found = derivatives(times_s, places_m, smoothing)[2][inner]
    error = np.linalg.norm(found - truth) / np.linalg.norm(truth)
    tops = [np.linalg.norm(one, axis=1).max() for one in (found, truth)]
    return float(error), float(tops[0] / tops[1] - 1.0)
