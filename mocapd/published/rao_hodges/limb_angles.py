"""The angles of limb chains from the rotations of bones, of another tracker's body or of a clip of motion."""

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.geometry import rotations
from mocapd.types import Floats

_BENT = 0.2  # sine of a bend from which on a hinge shows its plane
_DOWN, _AHEAD = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0])
_X = np.array([1.0, 0.0, 0.0])


def legs_angles(quats_xyzw: Floats) -> Floats:
    """(F,10): z, y, x of the thigh, knee and ankle of the left leg, then of the right one [rad]; quats_xyzw (F,J,4): global
    rotations. Each thigh is turned about itself by one angle, the same for all frames, that brings the shank into the plane
    of its hinge; what remains across that plane is left out."""
    return np.concatenate([_leg(quats_xyzw, side) for side in ("left", "right")], axis=1)


def arm_angles(quats_xyzw: Floats, side: str) -> Floats:
    """(F,4): x, y, z of the upper arm, elbow [rad]; the rest is as in `legs_angles`. The collar bone is the root."""
    out = 1.0 if side == "left" else -1.0
    shoulder = _local(quats_xyzw, side + "Shoulder", side + "UpperArm")
    forearm = _local(quats_xyzw, side + "UpperArm", side + "LowerArm")
    fore = rotations.rotate(forearm, out * _X)
    # an elbow bends forwards, to +z: the twist about x that takes +z there
    twist = _neutral_twist(np.arctan2(-fore[:, 1], fore[:, 2]), np.hypot(fore[:, 1], fore[:, 2]))
    turn = rotations.exp(twist * _X)
    fore = rotations.rotate(rotations.inverse(turn), fore)
    R = rotations.to_matrix(rotations.multiply(shoulder, turn))
    x, y, z = (
        np.arctan2(-R[:, 1, 2], R[:, 2, 2]),
        np.arcsin(np.clip(R[:, 0, 2], -1.0, 1.0)),
        np.arctan2(-R[:, 0, 1], R[:, 0, 0]),
    )
    return np.stack([x, y, z, np.arctan2(fore[:, 2], out * fore[:, 0])], axis=1)


def _leg(quats: Floats, side: str) -> Floats:
    hip = _local(quats, "hips", side + "UpperLeg")
    shank = rotations.rotate(_local(quats, side + "UpperLeg", side + "LowerLeg"), _DOWN)
    # a knee bends backwards, to -z: the twist about y that takes -z there
    twist = _neutral_twist(
        np.arctan2(-shank[:, 0], -shank[:, 2]), np.hypot(shank[:, 0], shank[:, 2])
    )
    turn = rotations.exp(np.array([0.0, twist, 0.0]))
    shank = rotations.rotate(rotations.inverse(turn), shank)
    knee = np.arctan2(-shank[:, 2], -shank[:, 1])
    thigh = rotations.multiply(hip, turn)
    R = rotations.to_matrix(thigh)
    z, y, x = (
        np.arctan2(R[:, 1, 0], R[:, 0, 0]),
        np.arcsin(np.clip(-R[:, 2, 0], -1.0, 1.0)),
        np.arctan2(R[:, 2, 1], R[:, 2, 2]),
    )
    below = rotations.multiply(thigh, rotations.exp(knee[:, None] * _X))
    toes = rotations.rotate(_local(quats, "hips", side + "Foot"), _AHEAD)
    toes = rotations.rotate(rotations.inverse(below), toes)
    return np.stack([z, y, x, knee, np.arctan2(-toes[:, 1], toes[:, 2])], axis=1)


def _local(quats: Floats, above: str, bone: str) -> Floats:
    return rotations.multiply(rotations.inverse(quats[:, INDEX[above]]), quats[:, INDEX[bone]])


def _neutral_twist(angle_rad: Floats, bend: Floats) -> float:
    """The direction of a hinge, of those (F,) of its frames by how much each is bent (F,)."""
    weight = np.where(bend > _BENT, bend**2, 0.0)
    if weight.sum() == 0.0:
        return 0.0
    return float(np.arctan2((weight * np.sin(angle_rad)).sum(), (weight * np.cos(angle_rad)).sum()))
