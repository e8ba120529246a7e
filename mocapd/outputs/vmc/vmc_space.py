"""Converts a person's pose to VMC's numbers in Unity's axes: mirrored and rotated. Pure, on the latency path.

Unity's world is left-handed with +Y up. An avatar at rest faces +Z as a person does in ours, but its left hand is at
-X where ours is at +X. So positions become (-x, y, z) and quaternions (x, -y, -z, w).

Scalars instead of numpy: with cold caches, once a frame, a numpy call costs five times as much as in a tight loop, and
forty of them cost more than scalar arithmetic for 22 bones.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mocapd.outputs.quaternions import IDENTITY_XYZW, inverse, multiply
from mocapd.outputs.vmc.avatar import Avatar
from mocapd.outputs.wire import Quaternion, Vector

Numbers = tuple[float, float, float, float, float, float, float]  # position [m] and quaternion xyzw


@dataclass(frozen=True, slots=True)
class VmcHeading:
    """A rotation about the world's vertical axis, applied to either the root or the hips.

    cos, sin: of its angle; root_xyzw, hips_xyzw: the rotation on the one, the identity on the other; by_root: True if
    the root also carries the translation over the floor.
    """

    cos: float
    sin: float
    root_xyzw: Quaternion
    hips_xyzw: Quaternion
    by_root: bool


def vmc_heading(turn_deg: float, yaw_deg: float, by_root: bool) -> VmcHeading:
    """The sum of both angles, counter-clockwise from above. by_root: rotation and horizontal translation are the root's."""
    heading_rad = math.radians(turn_deg + yaw_deg)
    heading: Quaternion = (0.0, math.sin(0.5 * heading_rad), 0.0, math.cos(0.5 * heading_rad))
    root, hips = (heading, IDENTITY_XYZW) if by_root else (IDENTITY_XYZW, heading)
    return VmcHeading(math.cos(heading_rad), math.sin(heading_rad), root, hips, by_root)


def vmc_poses(
    avatar: Avatar,
    where: VmcHeading,
    hips_m: Vector,
    locals_xyzw: Sequence[Quaternion],
    scale: float,
) -> list[Numbers]:
    """Local pose of the root and of each bone, in Unity's axes.

    hips_m: the person's hips in the world; locals_xyzw: the avatar's `local_rotations`; scale: the avatar's size
    relative to the person's.
    """
    x, y, z = (scale * along for along in hips_m)
    x, z = where.cos * x + where.sin * z, where.cos * z - where.sin * x
    # with by_root the hips carry only the height, which the heading does not change
    root, hips = ((x, 0.0, z), (0.0, y, 0.0)) if where.by_root else ((0.0, 0.0, 0.0), (x, y, z))
    offsets = (_transform(avatar.hips_from_world, hips), *avatar.offsets_m[1:])
    turns = (where.root_xyzw, *locals_xyzw)
    return [
        (-px, py, pz, qx, -qy, -qz, qw)
        for (px, py, pz), (qx, qy, qz, qw) in zip((root, *offsets), turns, strict=True)
    ]


def reflect_rotation(xyzw: Quaternion) -> Quaternion:
    """The mirror image at the plane x = 0, for the bone of the opposite side."""
    x, y, z, w = xyzw
    return x, -y, -z, w


def _transform(transform: Sequence[Sequence[float]], at_m: Vector) -> Vector:
    """Apply three rows of a rigid transform."""
    x, y, z = at_m
    a, b, c = (row[0] * x + row[1] * y + row[2] * z + row[3] for row in transform)
    return a, b, c


def apply_heading(where: VmcHeading, locals_xyzw: Sequence[Quaternion]) -> list[Quaternion]:
    """Local rotations of straight bones, with the heading applied to the hips."""
    return [multiply(where.hips_xyzw, locals_xyzw[0]), *locals_xyzw[1:]]


def local_rotations(
    avatar: Avatar, where: VmcHeading, turned_xyzw: Sequence[Quaternion]
) -> list[Quaternion]:
    """From global rotations relative to the T-pose to rotations relative to the parent node; heading applied to the hips.

    The parent node rotates with the parent bone a. With D the rotation relative to the T-pose, G the global rotation in
    the T-pose, n the parent node: (D_a G_n)^-1 (D_b G_b).
    """
    locals_xyzw = [multiply(where.hips_xyzw, turned_xyzw[0])]
    for parent, turn in zip(avatar.parents[1:], turned_xyzw[1:], strict=True):
        locals_xyzw.append(multiply(inverse(turned_xyzw[parent]), turn))
    if avatar.is_straight:
        return locals_xyzw
    return [
        multiply(from_above, multiply(turn, rest))
        for from_above, turn, rest in zip(
            avatar.from_above_xyzw, locals_xyzw, avatar.rest_xyzw, strict=True
        )
    ]
