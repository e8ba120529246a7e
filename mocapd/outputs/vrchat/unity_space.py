"""Converts poses from mocapd's world to VRChat's: Unity's axes, and Euler angles in degrees.

Unity is left-handed, +y up; forward is +z with the left towards -x. A person at rest in mocapd's world faces +Z with
the left towards +X. So x is negated, and a rotation of zero faces forward in both, as VRChat assumes of the head.
(SlimeVR, where a person faces -z, negates z; the two differ by half a turn.) Scalars, because a frame has only some
twenty vectors. Source: docs.vrchat.com/docs/osc-trackers.
"""

import math

from mocapd.outputs.wire import Quaternion, Vector

_LOCKED = 1.0 - 1e-9  # sine of the angle about x from which the other two turn about the same axis


def unity_position(world_m: Vector, turn: tuple[float, float]) -> Vector:
    """A world position [m], rotated about +Y by an angle of this cosine and sine, in Unity's axes [m]."""
    x, y, z = world_m
    cos, sin = turn
    return -(cos * x + sin * z), y, cos * z - sin * x


def unity_euler_deg(world_xyzw: Quaternion, half_turn: tuple[float, float]) -> Vector:
    """A rotation in the world, then one about +Y by an angle whose half has this cosine and sine, as Unity's
    Euler angles x y z [deg], each in -180..180: applied first about z, then x, then y."""
    qx, qy, qz, qw = world_xyzw
    cos, sin = half_turn
    # (0, sin, 0, cos) times q, and mirrored in x: a turn about y or z goes the other way round
    x, w = cos * qx + sin * qz, cos * qw - sin * qy
    y, z = -(cos * qy + sin * qw), -(cos * qz - sin * qx)
    # of the matrix R = Ry Rx Rz: R12 is -sin x
    sine = 2.0 * (w * x - y * z)
    if abs(sine) >= _LOCKED:
        about_x = math.copysign(90.0, sine)
        return about_x, math.degrees(2.0 * math.atan2(math.copysign(y, y * w), abs(w))), 0.0
    about_y = math.atan2(2.0 * (x * z + w * y), 1.0 - 2.0 * (x * x + y * y))
    about_z = math.atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z))
    return math.degrees(math.asin(sine)), math.degrees(about_y), math.degrees(about_z)


def cos_sin(angle_rad: float) -> tuple[float, float]:
    """Cosine and sine of an angle."""
    return math.cos(angle_rad), math.sin(angle_rad)
