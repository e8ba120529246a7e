"""The noise model of corners: a constant part, and one that grows with speed where a camera's timing is uneven."""

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.extrinsics.board_reprojection import (
    Observations,
    ReprojectionProblem,
    corner_speeds_px,
    residuals_px,
)
from mocapd.types import Floats

_UNEVEN_FRAMES = (0.0, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6, 1.0)  # trial values
_CORNERS_PX = 2.0 ** np.arange(-1.0, 1.01, 0.25)  # trial values, times the usual one
_TAIL = 4.0  # degrees of freedom: outliers weigh little
_WRONG = 4.0  # deviations of a view's median corner, above which the whole view is an outlier
_ONE_SIDED = 0.2  # relative error of the board's motion at positions with neighbours on one side
_GAIN = 10.0  # of log likelihood, in pictures, before timing counts as uneven


def usual_deviations_px(scene: ReprojectionProblem, obs: Observations, least_px: float) -> Floats:
    """(N,): standard deviation of each corner's x or y, the same for all, robust against outliers."""
    error_px = np.linalg.norm(residuals_px(scene, obs), axis=1)
    # of a Rayleigh distribution the median is 1.18 deviations
    usual_px = max(float(np.median(error_px)) / 1.18, least_px) if len(error_px) else least_px
    return np.full(len(error_px), usual_px)


def corner_deviations_px(scene: ReprojectionProblem, obs: Observations, least_px: float) -> Floats:
    """(N,): standard deviation of each corner's x or y, robust against outliers.

    The deviation of a corner at rest is that of all; by camera comes its speed times the deviation of the pictures'
    times, if that explains the errors far better. Student's t distribution, over a grid.
    """
    error_px = np.linalg.norm(residuals_px(scene, obs), axis=1)
    out = usual_deviations_px(scene, obs, least_px)
    usual_px = float(out[0]) if len(out) else least_px
    speed_px = corner_speeds_px(scene, obs)
    moving = speed_px > 0.0
    for camera in np.unique(obs.camera[moving]):
        own = (obs.camera == camera) & moving
        pictures = max(len(np.unique(obs.view[own])), 1)
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
    scene: ReprojectionProblem, obs: Observations, one_sided: NDArray[np.bool_]
) -> Floats:
    """(N,): of corners extrapolated along the board's motion from the position's instant to the picture's, at positions
    (V,) with neighbours on one side."""
    way_frames = np.abs(scene.delay[obs.camera] + obs.lag)
    return _ONE_SIDED * corner_speeds_px(scene, obs) * way_frames * one_sided[obs.view]


def in_wrong_views(
    scene: ReprojectionProblem, obs: Observations, deviation_px: Floats
) -> NDArray[np.bool_]:
    """(N,): corners of a view - one camera's of one position - of which half have large errors, relative to the camera,
    too: the pose or motion of the board is wrong, not single corners."""
    error = np.linalg.norm(residuals_px(scene, obs), axis=1) / deviation_px
    out = np.zeros(len(error), bool)
    for camera in np.unique(obs.camera):
        own = np.flatnonzero(obs.camera == camera)
        limit = _WRONG * max(1.0, float(np.median(error[own])) / 1.18)
        for view in np.unique(obs.view[own]):
            corners = own[obs.view[own] == view]
            out[corners] = np.median(error[corners]) > limit
    return out


def _log_likelihood(error_px: Floats, deviation_px: Floats) -> Floats:
    """Of distances in the plane, of Student's t distribution."""
    square = np.square(error_px / deviation_px)
    return -2.0 * np.log(deviation_px) - 0.5 * (_TAIL + 2.0) * np.log1p(square / _TAIL)
