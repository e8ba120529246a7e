"""The tables of `mocapd-analysis accuracy`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.accuracy.accelerations import acceleration_lines
from mocapd_analysis.accuracy.clips import BAND_HZ, END_S, Course, courses, read_clips
from mocapd_analysis.accuracy.daemon_smoothing import smoothing_lines
from mocapd_analysis.accuracy.methods import CHOSEN, METHODS, Velocity
from mocapd_analysis.accuracy.tracker_noise import TRACKED, Noise, draw
from mocapd_analysis.joint_speeds import highest

LEAST_M_S = 1.5  # of a peak: slower is no swing
FAST_M_S = 3.0
WITHIN = 0.05  # what is asked of a peak


@dataclass(frozen=True, slots=True)
class Condition:
    """How the clips are sampled. band_hz: what the truth has nothing above of; None: the clip as it is."""

    band_hz: float | None
    rate_hz: float
    noise: Noise | None

    @property
    def words(self) -> str:
        truth = (
            "the clip as it is" if self.band_hz is None else f"the clip up to {self.band_hz:g} Hz"
        )
        if self.noise is None:
            return f"{self.rate_hz:g} Hz, exact; truth: {truth}"
        return (
            f"{self.rate_hz:g} Hz, noise an axis {self.noise.white_m * 1e3:g} mm white and "
            f"{self.noise.slow_m * 1e3:g} mm fading in {self.noise.fades_s:g} s; truth: {truth}"
        )


CONDITIONS = (
    Condition(BAND_HZ, 30.0, TRACKED),
    Condition(BAND_HZ, 30.0, None),
    Condition(BAND_HZ, 60.0, TRACKED),
    Condition(BAND_HZ, 60.0, None),
    Condition(None, 30.0, TRACKED),
    Condition(None, 60.0, None),
)


def peak_errors(
    swings: Sequence[Course], condition: Condition, velocity: Velocity, seeds: int
) -> Floats:
    """Of every wrist's peak speed, the share that it comes out too high (N,); noise drawn `seeds` times."""
    errors = []
    for seed in range(seeds if condition.noise is not None else 1):
        random = np.random.default_rng(seed)
        for course in swings:
            step_s = 1.0 / condition.rate_hz
            # the frames fall anywhere on the motion
            times_s = np.arange(random.uniform(0.0, step_s), course.end_s, step_s)
            places_m = course.way_m(times_s)
            if condition.noise is not None:
                places_m = places_m + draw(condition.noise, len(times_s), condition.rate_hz, random)
            speed = np.linalg.norm(velocity(times_s, places_m), axis=1)
            inner = (times_s >= END_S) & (times_s <= course.end_s - END_S)
            errors.append(highest(times_s, speed, inner).value / course.peak_m_s - 1.0)
    return np.array(errors)


def accuracy_tables(folder: Path, seeds: int) -> Iterator[str]:
    """Line by line, as it is measured. Raises InputError."""
    clips = read_clips(folder)
    yield f"{len(clips)} clips; wrists whose peak is {LEAST_M_S:g} m/s and more; errors of the peak speed in percent"
    for condition in CONDITIONS:
        swings = courses(clips, condition.band_hz, LEAST_M_S)
        fast = np.array([course.peak_m_s >= FAST_M_S for course in swings])
        yield ""
        yield f"{condition.words}; {len(swings)} peaks, {fast.sum()} of {FAST_M_S:g} m/s and more"
        yield (
            f"{'':24}|   mean  median |.|  90 % below  within 5 % |"
            f" fast: median |.|  90 % below  within 5 %"
        )
        for name, velocity in METHODS.items():
            errors = peak_errors(swings, condition, velocity, seeds)
            of_fast = errors[np.tile(fast, len(errors) // len(fast))]
            yield (
                f"{name:22}{' *' if name == CHOSEN else '  '}| {100 * errors.mean():+6.1f} "
                f"{_figures(errors)} |      {_figures(of_fast)}"
            )
    yield ""
    yield CONDITIONS[0].words
    swings = courses(clips, CONDITIONS[0].band_hz, LEAST_M_S)
    yield from acceleration_lines(swings, CONDITIONS[0].rate_hz, TRACKED)
    yield ""
    yield from smoothing_lines(clips, LEAST_M_S)
    yield ""
    yield "* what the analyst uses"


def _figures(errors: Floats) -> str:
    size = np.abs(errors)
    if len(size) == 0:
        return f"{'-':>11} {'-':>11} {'-':>11}"
    return f"{100 * np.median(size):11.1f} {100 * np.quantile(size, 0.9):11.1f} {100 * (size <= WITHIN).mean():11.0f}"
