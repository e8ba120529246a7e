"""Where a second camera stands relative to a first: the motion that lays its bodies upon the first's.

Each camera alone fits a body of the typed stature, so this is metric at once. The textbook way, the
essential matrix of the points that both see, was measured on the same marks and lost: a person in the
middle of a room is small in depth, which left it 3 to 73 degrees off where this was 2.5 and 4.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.errors import ConfigError
from mocapd.types import Floats

_LEAST_POINTS = 80  # ten whole bodies
_LEAST_SHARE = 0.4  # of the points that must agree
_SCALE_M = 0.12  # a lone camera places a joint about so well, mostly in depth
_NEAR_M = 0.3
_ROUNDS = 20
_MOVE = "walk about, turn and move the arms where both cameras see the shirt"


@dataclass(frozen=True, slots=True, eq=False)
class RelativePose:
    """second_from_first: R (3,3), t_m (3,); inliers (N,) of the points given."""

    R: Floats
    t_m: Floats
    inliers: NDArray[np.bool_]


def relative_pose(first_m: Floats, second_m: Floats, weights: Floats) -> RelativePose:
    """From the same points (N,3) of a body in both cameras' frames, with weights (N,) >= 0.

    Rotation and translation of least squares [Umeyama, PAMI 1991], re-weighted by Geman-McClure.
    Raises ConfigError when the points do not tell: too few, or they do not agree.
    """
    if np.count_nonzero(weights > 0.0) < _LEAST_POINTS:
        raise ConfigError(
            f"{np.count_nonzero(weights > 0.0)} joints are seen by both cameras, "
            f"{_LEAST_POINTS} are needed",
            "room",
            _MOVE,
        )
    weight = weights.copy()
    R, t = np.eye(3), np.zeros(3)
    for _ in range(_ROUNDS):
        R, t = _rigid(first_m, second_m, weight)
        r2 = ((first_m @ R.T + t - second_m) ** 2).sum(axis=1)
        weight = weights * (_SCALE_M**2 / (_SCALE_M**2 + r2)) ** 2
    away = np.linalg.norm(first_m @ R.T + t - second_m, axis=1)
    inliers = (weights > 0.0) & (away < _NEAR_M)
    share = np.count_nonzero(inliers) / np.count_nonzero(weights > 0.0)
    if share < _LEAST_SHARE:
        raise ConfigError(
            f"only {100 * share:.0f} % of the joints agree on where the cameras stand",
            "room",
            "check that each lens belongs to its camera and no picture is mirrored, then " + _MOVE,
        )
    return RelativePose(R, t, inliers)


def _rigid(a: Floats, b: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """R, t of least squares with b = R a + t."""
    w = weight / max(weight.sum(), 1e-300)
    ca, cb = w @ a, w @ b
    U, _, Vt = np.linalg.svd((b - cb).T @ ((a - ca) * w[:, None]))
    R: Floats = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return R, cb - R @ ca
