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
_UNMOVED = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
_ON_FLOOR = np.array([1.0, 0.0, 1.0])
_MIRRORED_M = np.array([-1.0, 1.0, 1.0])
_MIRRORED_XYZW = np.array([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Placing:
    """heading_xyzw (4,): turns the person about the vertical through the world's origin; by_root: heading and travel over
    the floor are told of the root, not of the hips."""

    heading_xyzw: Floats
    by_root: bool


def placing(turn_deg: float, yaw_deg: float, by_root: bool) -> Placing:
    """Both turns together, counter-clockwise seen from above."""
    heading_rad = math.radians(turn_deg + yaw_deg)
    return Placing(rotations.exp(np.array([0.0, heading_rad, 0.0])), by_root)


def placed(
    avatar: Avatar, where: Placing, hips_m: Floats, turned_xyzw: Floats, scale: float
) -> Floats:
    """(1 + B, 7): position [m] and quaternion of the root and of each bone, local, in Unity's axes.

    hips_m (3,): the person's hips in the world; turned_xyzw (B,4): global rotations of the avatar's bones relative to the
    T-pose. scale: the avatar's size by the person's.
    """
    out = np.empty((1 + len(turned_xyzw), 7))
    at_m = hips_m * scale
    if where.by_root:
        out[0, :3] = rotations.rotate(where.heading_xyzw, at_m * _ON_FLOOR)
        out[0, 3:] = where.heading_xyzw
        at_m, hips_xyzw = at_m - at_m * _ON_FLOOR, turned_xyzw[0]
    else:
        out[0] = _UNMOVED
        at_m = rotations.rotate(where.heading_xyzw, at_m)
        hips_xyzw = rotations.multiply(where.heading_xyzw, turned_xyzw[0])
    out[1:, :3] = avatar.offsets_m
    out[1, :3] = avatar.hips_from_world[:3, :3] @ at_m + avatar.hips_from_world[:3, 3]
    out[1:, 3:] = _local(avatar, hips_xyzw, turned_xyzw)
    out *= _UNITY
    return out


def reflected(hips_m: Floats, turned_xyzw: Floats) -> tuple[Floats, Floats]:
    """Position and rotations at the plane x = 0; the rotations are then those of the other side's bones."""
    return hips_m * _MIRRORED_M, turned_xyzw * _MIRRORED_XYZW


def _local(avatar: Avatar, hips_xyzw: Floats, turned_xyzw: Floats) -> Floats:
    """Rotations (B,4) relative to the node directly above, which is turned as the bone above it is.

    With D the rotation since the T-pose, a of the bone above, G those of the T-pose, n of the node above:
    (D_a G_n)^-1 (D_b G_b).
    """
    above_xyzw = turned_xyzw[avatar.parents]
    above_xyzw[0] = rotations.IDENTITY_XYZW
    local_xyzw = rotations.multiply(rotations.inverse(above_xyzw), turned_xyzw)
    local_xyzw[0] = hips_xyzw
    if not avatar.is_straight:
        local_xyzw = rotations.multiply(local_xyzw, avatar.rest_xyzw)
        local_xyzw = rotations.multiply(rotations.inverse(avatar.above_xyzw), local_xyzw)
    return rotations.canonical(local_xyzw)
