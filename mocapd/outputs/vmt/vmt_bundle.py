"""The OSC bundle of a frame for the driver VMT: one message for each tracker, tracked or not.

`/VMT/Room/Driver` has index (0..57) and enable as int32, then time offset [s], x y z [m], qx qy qz qw as float32; VMT reads
no other types and counts (`OSCReceiver::ProcessMessage` of vmt_driver/CommunicationManager.cpp). `/VMT/Follow/Driver` has the
serial number of a device besides: places are then relative to that device's, the axes are the room's.

VMT holds a tracker's last pose for ever. So each frame has every tracker, and an untracked one has enable = 0, which
SteamVR shows as switched off; the first enable = 1 adds a tracker to SteamVR.
"""

import struct
from collections.abc import Sequence

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.wire import Quaternion, Vector

ROOM, FOLLOW = "/VMT/Room/Driver", "/VMT/Follow/Driver"
TYPES = "iiffffffff"
HEADSET = "HMD"  # VMT's alias for the serial number of the headset
OFF, TRACKER = 0, 1  # enable
_NOWHERE = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)

_numbers = struct.Struct(">2i8f")


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
