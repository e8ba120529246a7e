"""The OSC bundle of a frame for VRChat: `/tracking/trackers/<tracker>/{position,rotation}`, three floats each."""

import struct
from collections.abc import Sequence

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.wire import Vector

ROOT = "/tracking/trackers/"
TYPES = "fff"
HEAD_POSITION = f"{ROOT}head/position"
HEAD_ROTATION = f"{ROOT}head/rotation"

_three_floats = struct.Struct(">3f")


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
