"""How far off the corners are: by themselves, and more so the faster they move where a camera's time is not even."""

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.extrinsics.board_reprojection import (
    Observations,
    ReprojectionProblem,
    corner_speeds_px,
    residuals_px,
)
from mocapd.types import Floats

_UNEVEN_FRAMES = (0.0, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6, 1.0)  # tried
_CORNERS_PX = 2.0 ** np.arange(-1.0, 1.01, 0.25)  # tried, times the usual one
_TAIL = 4.0  # degrees of freedom: outliers count little
_WRONG = 4.0  # deviations of the middle corner of a view, above which all of the view is wrong
_ONE_SIDED = 0.2  # error of the board's motion where it is followed from one side, as a part of it
_GAIN = 10.0  # of log likelihood, in pictures, before time is called uneven


def usual_deviations_px(scene: ReprojectionProblem, seen: Observations, least_px: float) -> Floats:
    """(N,): standard deviation of each corner's x or y, the same for all, not minding outliers."""
    error_px = np.linalg.norm(residuals_px(scene, seen), axis=1)
    # of a Rayleigh distribution the median is 1.18 deviations
    usual_px = max(float(np.median(error_px)) / 1.18, least_px) if len(error_px) else least_px
    return np.full(len(error_px), usual_px)


def corner_deviations_px(scene: ReprojectionProblem, seen: Observations, least_px: float) -> Floats:
    """(N,): standard deviation of each corner's x or y, not minding outliers.

    The deviation of a corner at rest is that of all; by camera comes its speed times the deviation of the pictures'
    times, if that explains the errors far better. Student's t distribution, over a grid.
    """
    error_px = np.linalg.norm(residuals_px(scene, seen), axis=1)
    out = usual_deviations_px(scene, seen, least_px)
    usual_px = float(out[0]) if len(out) else least_px
    speed_px = corner_speeds_px(scene, seen)
    moving = speed_px > 0.0
    for camera in np.unique(seen.camera[moving]):
        own = (seen.camera == camera) & moving
        pictures = max(len(np.unique(seen.view[own])), 1)
        corners = own.sum() / pictures
        corner_px = np.maximum(usual_px * _CORNERS_PX, least_px)
        deviation = np.sqrt(
            np.square(corner_px)[:, None, None] + np.square(np.outer(_UNEVEN_FRAMES, speed_px[own]))
        )
        logs = _log_likelihood(error_px[own], deviation).sum(axis=2) / corners
        best = logs.max(axis=0)
        uneven = int(np.argmax(best))
        if best[uneven] > best[0] + _GAIN:
            out[own] = deviation[int(np.argmax(logs[:, uneven])), uneven]
    return out


def motion_deviations_px(
    scene: ReprojectionProblem, seen: Observations, one_sided: NDArray[np.bool_]
) -> Floats:
    """(N,): of corners from where the board's motion leads from its position's instant to that of the picture, where
    (V,) it is followed from one side."""
    way_frames = np.abs(scene.delay[seen.camera] + seen.lag)
    out: Floats = _ONE_SIDED * corner_speeds_px(scene, seen) * way_frames * one_sided[seen.view]
    return out


def in_wrong_views(
    scene: ReprojectionProblem, seen: Observations, deviation_px: Floats
) -> NDArray[np.bool_]:
    """(N,): corners of a view - one camera's of one position - of which half are far off, also by what is usual in
    that camera: a pose or a motion of the board that is wrong, and no error of single corners."""
    error = np.linalg.norm(residuals_px(scene, seen), axis=1) / deviation_px
    out = np.zeros(len(error), bool)
    for camera in np.unique(seen.camera):
        own = np.flatnonzero(seen.camera == camera)
        limit = _WRONG * max(1.0, float(np.median(error[own])) / 1.18)
        for view in np.unique(seen.view[own]):
            corners = own[seen.view[own] == view]
            out[corners] = np.median(error[corners]) > limit
    return out


def _log_likelihood(error_px: Floats, deviation_px: Floats) -> Floats:
    """Of distances in the plane, of Student's t distribution."""
    square = np.square(error_px / deviation_px)
    out: Floats = -2.0 * np.log(deviation_px) - 0.5 * (_TAIL + 2.0) * np.log1p(square / _TAIL)
    return out
