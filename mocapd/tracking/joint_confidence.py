"""How far each joint may be believed: how much of the body around it the pictures confirm, how well they place it, and
whether its keypoints agree."""

import numpy as np

from mocapd.body.areas import ARM_AREAS, N_AREAS, TORSO_QUARTERS, Area
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.tracking.tracking_state import FADE_S, confidence_fade
from mocapd.types import Floats

_ENOUGH_PX = 25.0  # confirmed pixels (of the half that is counted) for full confidence
# uncertainty that halves it, by the shirt: 0.05 ranks errors of two cameras a little better, but puts every joint of a single
# camera below the clients' thresholds; 0.10 gives full confidence to every third joint that is 10 cm off
_SHIRT_HALF_M = 0.06
_CLOTHES_HALF_M = 0.10  # the same by the clothes, whose uncertainties are twice the shirt's
_HALF_OFF_M = 0.15  # a distance from its keypoints that does, too
_HEAD = 0.5  # share of the neck's

_UPPER_TORSO = tuple(patch for patch in TORSO_QUARTERS if "UPPER" in patch.name)
_LOWER_TORSO = tuple(patch for patch in TORSO_QUARTERS if "LOWER" in patch.name)


def _patches_by_joint() -> dict[str, tuple[Area, ...]]:
    """The patches of the shirt that show each joint."""
    out = {
        "hips": _LOWER_TORSO, "spine": TORSO_QUARTERS, "chest": TORSO_QUARTERS,
        "upperChest": _UPPER_TORSO, "neck": _UPPER_TORSO,
    }  # fmt: skip
    for side in SIDES:
        sleeve = tuple(Area)[ARM_AREAS[side]]
        torso = tuple(p for p in _UPPER_TORSO if p.name.endswith(side.upper()))
        out[side + "Shoulder"] = (*torso, sleeve[0])
        out[side + "UpperArm"] = sleeve[:3]  # shoulder, upper arm
        out[side + "LowerArm"] = sleeve[1:5]  # upper arm, forearm
        out[side + "Hand"] = sleeve[3:]  # forearm, cuff
    return out


def _areas_by_joint() -> dict[str, tuple[Area, ...]]:
    """The areas of a body in any clothes that show each joint."""
    trunk = (Area.TORSO,)
    out: dict[str, tuple[Area, ...]] = dict.fromkeys(
        ("hips", "spine", "chest", "upperChest"), trunk
    )
    out |= dict.fromkeys(("neck", "head"), (Area.HEAD,))
    for side in SIDES:
        thigh, shin = Area[f"{side.upper()}_THIGH"], Area[f"{side.upper()}_SHIN"]
        arm = tuple(Area)[ARM_AREAS[side]]
        out[side + "Shoulder"] = (*trunk, arm[0])
        out[side + "UpperArm"] = arm[:3]
        out[side + "LowerArm"] = arm[1:5]
        out[side + "Hand"] = arm[3:]
        out[side + "UpperLeg"] = (*trunk, thigh)
        out[side + "LowerLeg"] = (thigh, shin)
        out[side + "Foot"] = out[side + "Toes"] = (shin,)
    return out


def _areas_of_joints(by_joint: dict[str, tuple[Area, ...]]) -> Floats:
    """(J,A): 1 where an area shows a joint."""
    out = np.zeros((N_JOINTS, N_AREAS))
    for name, areas in by_joint.items():
        if name in INDEX:
            out[INDEX[name], list(areas)] = 1.0
    return out


_PATCHES = _areas_of_joints(_patches_by_joint())
_AREAS = _areas_of_joints(_areas_by_joint())


def shirt_confidence(
    fit: Fit | None, n_cameras: int, uncertainty_m: Floats, away_s: float
) -> Floats:
    """(J,) in 0..1: confirmed share times visible amount, lower for uncertain places, fading without new evidence.

    A hidden arm is near 0, whatever pose the prior gives it; a single camera costs confidence by its uncertain depth. The
    head follows the neck; legs are 0. uncertainty_m (J,): one standard deviation of each place; away_s: since the last
    evidence [s].
    """
    if fit is None:
        return np.zeros(N_JOINTS)
    matched, asked = _PATCHES @ fit.matched, _PATCHES @ (fit.visible + fit.unexplained)
    out = _confirmed(matched, asked, n_cameras, uncertainty_m / _SHIRT_HALF_M)
    out[INDEX["head"]] = _HEAD * out[INDEX["neck"]]
    return np.asarray(out * np.exp(-away_s / FADE_S))


def clothes_confidence(
    fit: Fit | None, n_cameras: int, uncertainty_m: Floats, away_s: float
) -> Floats:
    """The same by the clothes, for all joints."""
    if fit is None:
        return np.zeros(N_JOINTS)
    matched = _AREAS @ (fit.matched * fit.in_depth)
    asked = _AREAS @ (fit.visible + fit.unexplained)
    out = _confirmed(matched, asked, n_cameras, uncertainty_m / _CLOTHES_HALF_M)
    return np.asarray(out * confidence_fade(away_s))


def _confirmed(matched: Floats, asked: Floats, n_cameras: int, uncertainty: Floats) -> Floats:
    """Confidence (J,) of joints with so many pixels around them that match, and that should; uncertainty: 1 halves it."""
    share = matched / np.maximum(asked, 1.0)
    enough = np.minimum(matched / (_ENOUGH_PX * max(n_cameras, 1)), 1.0)
    return np.asarray(np.minimum(1.25 * share, 1.0) * enough / (1.0 + uncertainty**2))


def keypoint_agreement(off_keypoints_m: Floats | None) -> Floats:
    """Factor of each joint's confidence (J,): lower where its keypoints contradict it. With it, confidence is about the share
    of such joints that are within 5 cm of their true place.

    off_keypoints_m (J,): see `ClothesEstimate`. Not for the pose filter: a joint that is contradicted moves as it is seen.
    """
    if off_keypoints_m is None:
        return np.ones(N_JOINTS)
    return np.asarray(1.0 / (1.0 + (off_keypoints_m / _HALF_OFF_M) ** 2))
