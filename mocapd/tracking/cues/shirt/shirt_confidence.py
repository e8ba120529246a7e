"""How far each joint may be believed: how much of the shirt around it the pictures confirm, and how well they place it."""

import numpy as np

from mocapd.body.areas import ARM_AREAS, N_AREAS, TORSO_QUARTERS, Area
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.tracking.tracking_state import FADE_S
from mocapd.types import Floats

_ENOUGH_PX = 25.0  # confirmed pixels (of the half that is counted) for full confidence
# uncertainty that halves it: 0.05 ranks errors of two cameras a little better, but puts every joint of a single camera
# below the clients' thresholds; 0.10 gives full confidence to every third joint that is 10 cm off
_HALF_M = 0.06
_HEAD = 0.5  # share of the neck's

_UPPER_TORSO = tuple(patch for patch in TORSO_QUARTERS if "UPPER" in patch.name)
_LOWER_TORSO = tuple(patch for patch in TORSO_QUARTERS if "LOWER" in patch.name)


def _patches_by_joint() -> dict[str, tuple[Area, ...]]:
    """The patches that show each joint."""
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


def _patches_of_joints() -> Floats:
    out = np.zeros((N_JOINTS, N_AREAS))
    for name, patches in _patches_by_joint().items():
        out[INDEX[name], list(patches)] = 1.0
    return out


_PATCHES = _patches_of_joints()


def joint_confidence(
    fit: Fit | None, n_cameras: int, uncertainty_m: Floats, away_s: float
) -> Floats:
    """(J,) in 0..1: confirmed share times visible amount, lower for uncertain places, fading without new evidence.

    A hidden arm is near 0, whatever pose the prior gives it; a single camera costs confidence by its uncertain depth. The
    head follows the neck; legs are 0. uncertainty_m (J,):
    one standard deviation of each place; away_s: since the last evidence [s].
    """
    if fit is None:
        return np.zeros(N_JOINTS)
    matched = _PATCHES @ fit.matched
    asked = _PATCHES @ (fit.visible + fit.unexplained)
    share = matched / np.maximum(asked, 1.0)
    enough = np.minimum(matched / (_ENOUGH_PX * max(n_cameras, 1)), 1.0)
    out = np.minimum(1.25 * share, 1.0) * enough
    out /= 1.0 + (uncertainty_m / _HALF_M) ** 2
    out[INDEX["head"]] = _HEAD * out[INDEX["neck"]]
    return np.asarray(out * np.exp(-away_s / FADE_S))
