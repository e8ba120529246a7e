"""From mocapd's world to SteamVR's room: turned by half a turn, then by a heading about the vertical.

Both are right-handed, +y up, in metres. A person at rest faces +Z in ours, and forward in SteamVR is -z. So (x, y, z) becomes
(-x, y, -z), and a quaternion (-x, y, -z, w): the T-pose that faces forward has no rotation in either. This is what
`/VMT/Room/Driver` and `/VMT/Follow/Driver` take as it is; the addresses that end in `Unity` would negate z.
Scalars, as there are some twenty of them a frame.
"""

import math

from mocapd.outputs.quaternions import rotate
from mocapd.outputs.wire import Joint, Quaternion, Vector

_EYES_M = (0.0, 0.08, 0.09)  # of the eyes from the head's joint, in the T-pose [m]

Turn = tuple[float, float, float, float]  # cosine and sine of an angle, and of its half


def turn_by(angle_rad: float) -> Turn:
    """About +Y, counter-clockwise seen from above."""
    half_rad = 0.5 * angle_rad
    return math.cos(angle_rad), math.sin(angle_rad), math.cos(half_rad), math.sin(half_rad)


def room_position(world_m: Vector, turn: Turn) -> Vector:
    """A place, or a way from one to another, in the room's axes [m]."""
    x, y, z = -world_m[0], world_m[1], -world_m[2]
    cos, sin, _, _ = turn
    return cos * x + sin * z, y, cos * z - sin * x


def room_rotation(world_xyzw: Quaternion, turn: Turn) -> Quaternion:
    """A rotation since the T-pose, in the room's axes."""
    x, y, z, w = -world_xyzw[0], world_xyzw[1], -world_xyzw[2], world_xyzw[3]
    _, _, cos, sin = turn
    # (0, sin, 0, cos) times q
    return cos * x + sin * z, cos * y + sin * w, cos * z - sin * x, cos * w - sin * y


def eyes_m(head: Joint) -> Vector:
    """Where a headset is, by the head's joint and how it is turned [m]."""
    x, y, z = rotate(head.r, _EYES_M)
    return head.p[0] + x, head.p[1] + y, head.p[2] + z
