"""Checks whether one of two cameras shows people larger or smaller than calibrated, from the intersections of joints.

A zoom by a fifth moves joints by no more than the joint network's error, so the views still seem to agree. But errors of
joints have no common scale. Enlarging one camera's pictures about their middle brings the joints nearer to their
epipolar lines in every stretch of time, or in none (robust linear least squares).
"""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.person_views import PersonView
from mocapd.calibrate.consistency.rig_judge import Stretch
from mocapd.calibrate.consistency.room_points import epipolar_equations
from mocapd.calibrate.consistency.view_agreement import fit_pair, resample_view
from mocapd.types import Camera, Floats

_FITS = 1.5  # cost of two views of one person
_LEAST = 60  # joints of a stretch
_ITERATIONS = 15
_JOINT_OFF = float(np.radians(0.5))  # of the joint network
_SHIFT = 0.01  # of pictures, in focal lengths
_JOINTS = 60  # as many joints would be needed to show such a shift
_SD = 0.02  # of a scale that counts: cameras that face each other measure none
_BOTH = 0.17  # sum of the logarithms of the two cameras' scales, which are opposite: 0.13 for correct cameras
_LEAST_STRETCHES = 2


def scaled_findings(
    cameras: Sequence[Camera], stretches: Sequence[Stretch]
) -> Iterator[CaptureFinding]:
    """Findings of the two cameras that disagree most about the size of people; empty without a clear case."""
    worst, which = _BOTH, None
    for i, j in combinations(range(len(cameras)), 2):
        scales = [
            scales
            for views in stretches
            if (scales := _scales((cameras[i], cameras[j]), views[i], views[j])) is not None
        ]
        if len(scales) < _LEAST_STRETCHES:
            continue
        logs = np.log(scales)
        # true in every stretch: the smallest scale in the first camera's sense, and in the opposite one's
        for sense in (1.0, -1.0):
            held = float((sense * logs[:, 0]).min() + (-sense * logs[:, 1]).min())
            if held > worst:
                worst, which = held, (i, j, sense)
    if which is None:
        return
    i, j, sense = which
    first, second = ("larger", "smaller") if sense > 0.0 else ("smaller", "larger")
    a, b = cameras[i].name, cameras[j].name
    yield CaptureFinding(
        Mistake.ZOOMED,
        (a, b),
        f"people are {first} in the pictures of {a!r} than calibrated, or {second} in those of {b!r}",
        "were their pictures cut, zoomed or letterboxed after calibration? Record as then, or calibrate again",
    )


def _scales(
    cameras: tuple[Camera, Camera], first: Sequence[PersonView], second: Sequence[PersonView]
) -> tuple[float, float] | None:
    """How many times larger than calibrated each camera shows their common person in a stretch, assuming that the other
    camera is right."""
    best, most = None, _FITS
    for a in first:
        for b in second:
            fit = fit_pair(cameras, (a, b))
            if fit is not None and fit.cost < most:
                best, most = (a, b), fit.cost
    if best is None:
        return None
    a, b = best[0], resample_view(best[1], best[0].times_s)
    both = a.sure & b.sure & np.isfinite(b.px[..., 0])
    if both.sum() < _LEAST:
        return None
    px = a.px[both], b.px[both]
    estimates = [_scale(cameras, px, index) for index in (0, 1)]
    if max(sd for _, sd in estimates) > _SD:
        return None
    return estimates[0][0], estimates[1][0]


def _scale(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], index: int
) -> tuple[float, float]:
    """The scale of one camera's pictures, and its standard deviation."""
    A, b = epipolar_equations(cameras, px, index)
    prior = np.diag([0.0, 1.0, 1.0]) * (_JOINT_OFF / _SHIFT) ** 2 * len(b) / _JOINTS
    x, normal = np.array([1.0, 0.0, 0.0]), np.eye(3)
    for _ in range(_ITERATIONS):
        weights = 1.0 / np.maximum(1.0, np.abs(A @ x - b) / _JOINT_OFF)
        weighted = (A * weights[:, None]).T
        normal = weighted @ A + prior + 1e-12 * np.eye(3)
        x = np.linalg.solve(normal, weighted @ b)
    sd = float(np.sqrt(np.linalg.inv(normal)[0, 0]) * _JOINT_OFF)
    return 1.0 / max(float(x[0]), 1e-3), sd
