"""Relative pose of two cameras: the rigid motion that aligns their bodies.

Each camera alone fits a body of the typed stature, so the result is metric at once. The textbook method, the essential
matrix of common points, lost on the same marks: a person in the middle of a room has little depth, which left it 3 to 73
degrees off where this was 2.5 and 4.
"""

import numpy as np

from mocapd.errors import ConfigError
from mocapd.geometry.rigid_transforms import IDENTITY, RigidTransform, align_points
from mocapd.types import Floats

_LEAST_POINTS = 80  # ten whole bodies
_LEAST_SHARE = 0.4  # of the points that must agree
_SCALE_M = 0.12  # accuracy of a joint by a single camera, mostly in depth
_NEAR_M = 0.3
_ROUNDS = 20
_MOVE = "walk about, turn and move the arms where both cameras see the shirt"


def relative_pose(first_m: Floats, second_m: Floats, weights: Floats) -> RigidTransform:
    """second_from_first, from the same points (N,3) of a body in both cameras' frames, with weights (N,) >= 0.

    Least squares, re-weighted by Geman-McClure.
    Raises ConfigError for too few points, or points that do not agree.
    """
    count = np.count_nonzero(weights > 0.0)
    if count < _LEAST_POINTS:
        raise ConfigError(
            f"{count} joints are seen by both cameras, {_LEAST_POINTS} are needed", "room", _MOVE
        )
    weight = weights.copy()
    second_from_first = IDENTITY
    for _ in range(_ROUNDS):
        second_from_first = align_points(second_m, first_m, weight)
        r2 = ((second_from_first.apply(first_m) - second_m) ** 2).sum(axis=1)
        weight = weights * (_SCALE_M**2 / (_SCALE_M**2 + r2)) ** 2
    away = np.linalg.norm(second_from_first.apply(first_m) - second_m, axis=1)
    share = np.count_nonzero((weights > 0.0) & (away < _NEAR_M)) / count
    if share < _LEAST_SHARE:
        raise ConfigError(
            f"only {100 * share:.0f} % of the joints agree on where the cameras stand",
            "room",
            "check that each lens belongs to its camera and no picture is mirrored, then " + _MOVE,
        )
    return second_from_first
