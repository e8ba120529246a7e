"""How far each joint may be believed: how much of the body around it the pictures confirm, how well they place it, and
whether its keypoints agree."""

import numpy as np

from mocapd.body.areas import ARM_AREAS, N_AREAS, Area
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.tracking.tracking_state import confidence_fade
from mocapd.types import Floats

_ENOUGH_PX = 25.0  # confirmed pixels (of the half that is counted) for full confidence
_HALF_M = 0.10  # an uncertainty that halves it: this tracker's are twice the shirt's
_HALF_OFF_M = 0.15  # a distance from its keypoints that does, too


def _areas_by_joint() -> dict[str, tuple[int, ...]]:
    """The areas that show each joint."""
    trunk = (Area.TORSO,)
    out: dict[str, tuple[int, ...]] = dict.fromkeys(("hips", "spine", "chest", "upperChest"), trunk)
    out |= dict.fromkeys(("neck", "head"), (Area.HEAD,))
    for side, thigh, shin in (
        ("left", Area.LEFT_THIGH, Area.LEFT_SHIN),
        ("right", Area.RIGHT_THIGH, Area.RIGHT_SHIN),
    ):
        arm = tuple(range(N_AREAS)[ARM_AREAS[side]])
        out[side + "Shoulder"] = (*trunk, arm[0])
        out[side + "UpperArm"] = arm[:3]
        out[side + "LowerArm"] = arm[1:5]
        out[side + "Hand"] = arm[3:]
        out[side + "UpperLeg"] = (*trunk, thigh)
        out[side + "LowerLeg"] = (thigh, shin)
        out[side + "Foot"] = out[side + "Toes"] = (shin,)
    return out


def _areas_of_joints() -> Floats:
    out = np.zeros((N_JOINTS, N_AREAS))
    for name, mine in _areas_by_joint().items():
        if name in INDEX:
            out[INDEX[name], list(mine)] = 1.0
    return out


_AREAS = _areas_of_joints()


def joint_confidence(
    fit: Fit | None, n_cameras: int, uncertainty_m: Floats, away_s: float
) -> Floats:
    """(J,) in 0..1: confirmed share times visible amount, lower for uncertain places, fading without new evidence.

    uncertainty_m (J,): one standard deviation of each place; away_s: since the last evidence [s].
    """
    if fit is None:
        return np.zeros(N_JOINTS)
    matched = _AREAS @ (fit.matched * fit.in_depth)
    asked = _AREAS @ (fit.visible + fit.unexplained)
    share = matched / np.maximum(asked, 1.0)
    enough = np.minimum(matched / (_ENOUGH_PX * max(n_cameras, 1)), 1.0)
    out = np.minimum(1.25 * share, 1.0) * enough / (1.0 + (uncertainty_m / _HALF_M) ** 2)
    return np.asarray(out * confidence_fade(away_s))


def keypoint_agreement(off_keypoints_m: Floats | None) -> Floats:
    """Factor of each joint's confidence (J,): lower where its keypoints contradict it. With it, confidence is about the share
    of such joints that are within 5 cm of their true place.

    off_keypoints_m (J,): see `ClothesEstimate`. Not for the pose filter: a joint that is contradicted moves as it is seen.
    """
    if off_keypoints_m is None:
        return np.ones(N_JOINTS)
    return np.asarray(1.0 / (1.0 + (off_keypoints_m / _HALF_OFF_M) ** 2))
