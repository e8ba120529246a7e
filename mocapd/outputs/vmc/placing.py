"""From a person in the world to VMC's numbers: mirrored, turned, and in Unity's axes. Pure, on the latency path.

Unity's world is left-handed with +Y up, and an avatar at rest faces +Z as a person does in ours,
with the left hand at -X where ours is at +X: x is turned round, of positions (-x, y, z) and so of
quaternions (x, -y, -z, w).
"""

import math
from dataclasses import dataclass

import numpy as np

from mocapd.geometry import rotations
from mocapd.outputs.vmc.avatar import Avatar
from mocapd.types import Floats

_UNITY = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 1.0])  # of position and quaternion
_MIRRORED_M = np.array([-1.0, 1.0, 1.0])
_MIRRORED_XYZW = np.array([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Placing:
    """Where the person is turned to, and which of root and hips carries it.

    R (3,3): about the vertical through the world's origin; root_xyzw, hips_xyzw (4,): the same, or none; root_share (3,):
    by axis, 1 where the root carries the way.
    """

    R: Floats
    root_xyzw: Floats
    hips_xyzw: Floats
    root_share: Floats


def placing(turn_deg: float, yaw_deg: float, by_root: bool) -> Placing:
    """Both turns together, counter-clockwise seen from above. by_root: they and the way over the floor are the root's."""
    heading_xyzw = rotations.exp(np.array([0.0, math.radians(turn_deg + yaw_deg), 0.0]))
    R, none_xyzw = rotations.to_matrix(heading_xyzw), rotations.IDENTITY_XYZW
    if by_root:
        return Placing(R, heading_xyzw, none_xyzw, np.array([1.0, 0.0, 1.0]))
    return Placing(R, none_xyzw, heading_xyzw, np.zeros(3))


def placed(
    avatar: Avatar, where: Placing, hips_m: Floats, turned_xyzw: Floats, scale: float
) -> Floats:
    """(1 + B, 7): position [m] and quaternion of the root and of each bone, local, in Unity's axes.

    hips_m (3,): the person's hips in the world; turned_xyzw (B,4): global rotations of the avatar's bones relative to the
    T-pose. scale: the avatar's size by the person's.
    """
    at_m = where.R @ (hips_m * scale)
    root_m = at_m * where.root_share
    out = np.empty((1 + len(turned_xyzw), 7))
    out[0, :3], out[0, 3:] = root_m, where.root_xyzw
    out[1:, :3] = avatar.offsets_m
    # what the root does not carry is straight up, which its heading leaves as it is
    out[1, :3] = avatar.hips_from_world[:3, :3] @ (at_m - root_m) + avatar.hips_from_world[:3, 3]
    out[1:, 3:] = _local(avatar, where.hips_xyzw, turned_xyzw)
    out *= _UNITY
    return out


def reflected(hips_m: Floats, turned_xyzw: Floats) -> tuple[Floats, Floats]:
    """Position and rotations at the plane x = 0; the rotations are then those of the other side's bones."""
    return hips_m * _MIRRORED_M, turned_xyzw * _MIRRORED_XYZW


def _local(avatar: Avatar, heading_xyzw: Floats, turned_xyzw: Floats) -> Floats:
    """Rotations (B,4) relative to the node directly above, which is turned as the bone above it is; the hips by the heading.

    With D the rotation since the T-pose, a of the bone above, G those of the T-pose, n of the node above:
    (D_a G_n)^-1 (D_b G_b).
    """
    from_above_xyzw = rotations.inverse(turned_xyzw[avatar.parents])
    from_above_xyzw[0] = heading_xyzw
    local_xyzw = rotations.multiply(from_above_xyzw, turned_xyzw)
    if avatar.is_straight:
        return local_xyzw
    local_xyzw = rotations.multiply(local_xyzw, avatar.rest_xyzw)
    return rotations.multiply(avatar.from_above_xyzw, local_xyzw)
