"""The OSC bundle of a frame for VRChat: `/tracking/trackers/<tracker>/{position,rotation}`, three floats each.

Unity is left-handed, +y up; forward is +z with the left towards -x. A person at rest in mocapd's world faces +Z with
the left towards +X. So x is negated, and a rotation of zero faces forward in both, as VRChat assumes of the head.
(SlimeVR, where a person faces -z, negates z; the two differ by half a turn.) Scalars, because a frame has only some
twenty vectors. Source: docs.vrchat.com/docs/osc-trackers.
"""

import math
import struct
from collections.abc import Sequence

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.wire import Quaternion, Vector

ROOT = "/tracking/trackers/"
TYPES = "fff"
HEAD_POSITION = f"{ROOT}head/position"
HEAD_ROTATION = f"{ROOT}head/rotation"

_three_floats = struct.Struct(">3f")


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
    return math.cos(angle_rad), math.sin(angle_rad)


def position_address(number: int) -> str:
    """The address of a tracker's position."""
    return f"{ROOT}{number}/position"


def rotation_address(number: int) -> str:
    """The address of a tracker's rotation."""
    return f"{ROOT}{number}/rotation"


class TrackerBundle:
    """The bundle for frames with these addresses: built once, the floats overwritten per frame.

    Eight trackers and the head take 1032 bytes, so one datagram holds any frame.
    """

    def __init__(self, addresses: Sequence[str]) -> None:
        messages = [osc.message(address, TYPES, 0.0, 0.0, 0.0) for address in addresses]
        self._data, self._floats_at = osc.bundle(messages)

    def fill(self, vectors: Sequence[Vector]) -> bytearray:
        """The datagram with one vector for each address; it is overwritten by the next call."""
        for at, vector in zip(self._floats_at, vectors, strict=True):
            _three_floats.pack_into(self._data, at, *vector)
        return self._data
