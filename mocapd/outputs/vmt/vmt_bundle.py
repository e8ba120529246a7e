"""The OSC bundle of a frame for the driver VMT: one message for each tracker, tracked or not.

`/VMT/Room/Driver` has index (0..57) and enable as int32, then time offset [s], x y z [m], qx qy qz qw as float32; VMT reads
no other types and counts (`OSCReceiver::ProcessMessage` of vmt_driver/CommunicationManager.cpp). `/VMT/Follow/Driver` has the
serial number of a device besides: places are then relative to that device's, the axes are the room's.

VMT holds a tracker's last pose for ever. So each frame has every tracker, and an untracked one has enable = 0, which
SteamVR shows as switched off; the first enable = 1 adds a tracker to SteamVR.

Poses go from mocapd's world to SteamVR's room by half a turn, then by a heading about the vertical. Both are right-handed,
+y up, in metres. A person at rest faces +Z in ours, and forward in SteamVR is -z. So (x, y, z) becomes (-x, y, -z), and a
quaternion (-x, y, -z, w): the T-pose that faces forward has no rotation in either. This is what `/VMT/Room/Driver` and
`/VMT/Follow/Driver` take as it is; the addresses that end in `Unity` would negate z. Scalars, as there are some twenty of
them a frame.
"""

import math
import struct
from collections.abc import Sequence

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.quaternions import rotate
from mocapd.outputs.wire import Joint, Quaternion, Vector

ROOM, FOLLOW = "/VMT/Room/Driver", "/VMT/Follow/Driver"
TYPES = "iiffffffff"
HEADSET = "HMD"  # VMT's alias for the serial number of the headset
OFF, TRACKER = 0, 1  # enable
_NOWHERE = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)

_numbers = struct.Struct(">2i8f")


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


class VmtBundle:
    """Built once, the numbers overwritten per frame. Eight trackers take 688 bytes at most: one datagram."""

    def __init__(self, indices: Sequence[int], follows_headset: bool) -> None:
        """indices: of the trackers in SteamVR, whose names are VMT_<index>."""
        self._indices = tuple(indices)
        numbers = (0, 0, *(0.0,) * 8)
        messages = [
            osc.message(FOLLOW, f"{TYPES}s", *numbers, HEADSET)
            if follows_headset
            else osc.message(ROOM, TYPES, *numbers)
            for _ in self._indices
        ]
        self._data, self._numbers_at = osc.bundle(messages)

    def fill(self, poses: Sequence[tuple[Vector, Quaternion] | None]) -> bytearray:
        """The datagram with a position and rotation for each tracker, None: off. The next call overwrites it."""
        for at, index, pose in zip(self._numbers_at, self._indices, poses, strict=True):
            place, turn = pose or _NOWHERE
            enable = OFF if pose is None else TRACKER
            _numbers.pack_into(self._data, at, index, enable, 0.0, *place, *turn)
        return self._data
