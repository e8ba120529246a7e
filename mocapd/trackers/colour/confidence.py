"""How far each joint may be believed: from the share of the shirt around it that the pictures confirm."""

import numpy as np

from mocapd.body.shirt import N_PATCHES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.trackers.colour.fitting import Fit
from mocapd.trackers.tracking_state import FADE_S
from mocapd.types import Floats

_ENOUGH_PX = 25.0  # confirmed pixels (of the half that is counted) at which a joint is well seen
_ONE_CAMERA = 0.7  # one view knows directions, not depth
_BELOW = 0.5  # what the shirt tells of head and legs

_TORSO = tuple(range(1, 9))
_SEEN_BY: dict[str, tuple[int, ...]] = {
    "hips": (3, 4, 7, 8), "spine": _TORSO, "chest": _TORSO, "upperChest": (1, 2, 5, 6),
    "neck": (1, 2, 5, 6), "leftShoulder": (1, 5, 9), "rightShoulder": (2, 6, 15),
    "leftUpperArm": (9, 10, 11), "leftLowerArm": (10, 11, 12, 13), "leftHand": (12, 13, 14),
    "rightUpperArm": (15, 16, 17), "rightLowerArm": (16, 17, 18, 19), "rightHand": (18, 19, 20),
}  # fmt: skip
_FOLLOWS = {
    "head": "neck",
    **{f"{side}{bone}": "hips" for side in ("left", "right") for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes")},
}  # fmt: skip


def _patches_of_joints() -> Floats:
    out = np.zeros((N_JOINTS, N_PATCHES + 1))
    for name, patches in _SEEN_BY.items():
        out[INDEX[name], list(patches)] = 1.0
    return out


_PATCHES = _patches_of_joints()


def joint_confidence(fit: Fit | None, n_cameras: int, away_s: float) -> Floats:
    """(J,) in 0..1: confirmed share times how much of it is seen, fading while there is no evidence.

    A hidden arm is near 0, whatever pose the prior gives it. away_s: since the last evidence [s].
    """
    if fit is None:
        return np.zeros(N_JOINTS)
    matched = _PATCHES @ fit.matched
    asked = _PATCHES @ (fit.visible + fit.unexplained)
    share = matched / np.maximum(asked, 1.0)
    enough = np.minimum(matched / (_ENOUGH_PX * max(n_cameras, 1)), 1.0)
    out = np.minimum(1.25 * share, 1.0) * enough
    for name, source in _FOLLOWS.items():
        out[INDEX[name]] = _BELOW * out[INDEX[source]]
    if n_cameras < 2:
        out *= _ONE_CAMERA
    return np.asarray(out * np.exp(-away_s / FADE_S))
