"""From a person in the world to VMC's numbers: mirrored, turned, and in Unity's axes. Pure, on the latency path.

Unity's world is left-handed with +Y up, and an avatar at rest faces +Z as a person does in ours,
with the left hand at -X where ours is at +X: x is turned round, of positions (-x, y, z) and so of
quaternions (x, -y, -z, w).

Scalars: a frame comes after milliseconds of other work, when a call of numpy costs five times what it does in a
loop of its own, and these forty cost more than the 22 bones.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mocapd.outputs.quaternions import IDENTITY_XYZW, inverse, multiply
from mocapd.outputs.vmc.avatar import Avatar
from mocapd.outputs.wire import Quaternion, Vector

Numbers = tuple[float, float, float, float, float, float, float]  # position [m] and quaternion xyzw


@dataclass(frozen=True, slots=True)
class Placing:
    """Where the person is turned to, and which of root and hips carries it.

    cos, sin: of the turn about the vertical through the world's origin; root_xyzw, hips_xyzw: the same as a rotation, or
    none; by_root: whether the root carries the way over the floor.
    """

    cos: float
    sin: float
    root_xyzw: Quaternion
    hips_xyzw: Quaternion
    by_root: bool


def placing(turn_deg: float, yaw_deg: float, by_root: bool) -> Placing:
    """Both turns together, counter-clockwise seen from above. by_root: they and the way over the floor are the root's."""
    heading_rad = math.radians(turn_deg + yaw_deg)
    heading: Quaternion = (0.0, math.sin(0.5 * heading_rad), 0.0, math.cos(0.5 * heading_rad))
    root, hips = (heading, IDENTITY_XYZW) if by_root else (IDENTITY_XYZW, heading)
    return Placing(math.cos(heading_rad), math.sin(heading_rad), root, hips, by_root)


def placed(
    avatar: Avatar, where: Placing, hips_m: Vector, locals_xyzw: Sequence[Quaternion], scale: float
) -> list[Numbers]:
    """Of the root and of each bone, local, in Unity's axes.

    hips_m: the person's hips in the world; locals_xyzw: of the avatar's bones, as of
    `local_rotations`.
    scale: the avatar's size by the person's.
    """
    x, y, z = (scale * along for along in hips_m)
    x, z = where.cos * x + where.sin * z, where.cos * z - where.sin * x
    # what the root does not carry is straight up, which its heading leaves as it is
    root, hips = ((x, 0.0, z), (0.0, y, 0.0)) if where.by_root else ((0.0, 0.0, 0.0), (x, y, z))
    offsets = (_moved(avatar.hips_from_world, hips), *avatar.offsets_m[1:])
    turns = (where.root_xyzw, *locals_xyzw)
    return [
        (-px, py, pz, qx, -qy, -qz, qw)
        for (px, py, pz), (qx, qy, qz, qw) in zip((root, *offsets), turns, strict=True)
    ]


def reflected_turn(xyzw: Quaternion) -> Quaternion:
    """At the plane x = 0; it is then that of the other side's bone."""
    x, y, z, w = xyzw
    return x, -y, -z, w


def _moved(transform: Sequence[Sequence[float]], at_m: Vector) -> Vector:
    """By three rows of a rigid transform."""
    x, y, z = at_m
    a, b, c = (row[0] * x + row[1] * y + row[2] * z + row[3] for row in transform)
    return a, b, c


def headed(where: Placing, locals_xyzw: Sequence[Quaternion]) -> list[Quaternion]:
    """Local rotations of straight bones, the hips turned by the heading that they carry."""
    return [multiply(where.hips_xyzw, locals_xyzw[0]), *locals_xyzw[1:]]


def local_rotations(
    avatar: Avatar, where: Placing, turned_xyzw: Sequence[Quaternion]
) -> list[Quaternion]:
    """From global rotations since the T-pose to those relative to the node directly above, which is turned as the bone
    above it is; the hips by the heading that they carry.

    With D the rotation since the T-pose, a of the bone above, G those of the T-pose, n of the node above:
    (D_a G_n)^-1 (D_b G_b).
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
