"""The messages of one VMC frame, built once; per frame only numbers are overwritten.

Performer to Marionette, protocol V2.7 (protocol.vmc.info/english): `/VMC/Ext/OK iiii`,
`/VMC/Ext/T f`, `/VMC/Ext/Root/Pos sfffffff`, `/VMC/Ext/Bone/Pos sfffffff`. Types are i, f and s
only and argument lists complete: several receivers crash on others.
"""

import struct
from collections.abc import Iterator, Sequence
from typing import Literal

from pythonosc.osc_message import OscMessage

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.vmc.bone_names import unity_name
from mocapd.outputs.vmc.vmc_space import Numbers

Bundling = Literal["two", "one", "off"]

OK, OK_TYPES = "/VMC/Ext/OK", "iiii"
TIME, TIME_TYPES = "/VMC/Ext/T", "f"
ROOT, BONE, POSE_TYPES = "/VMC/Ext/Root/Pos", "/VMC/Ext/Bone/Pos", "sfffffff"

_ok_numbers = struct.Struct(">4i")
_pose_numbers = struct.Struct(">7f")
_time_number = struct.Struct(">f")
_LEGS = ("UpperLeg", "LowerLeg", "Foot", "Toes")

_Place = tuple[bytearray, int]  # a datagram, and the offset of a message's numbers in it


class VmcPackets:
    """The datagrams for these bones, by VRM 1.0 name; without bones, OK and T alone.

    two: bundles of at most 1472 bytes, trunk and arms before legs: two for 22 bones; one: a single bundle of any size;
    off: a datagram for each message.
    """

    def __init__(self, bones: Sequence[str], bundling: Bundling) -> None:
        legs = [bone for bone in bones if bone.endswith(_LEGS)]
        rest = [bone for bone in bones if not bone.endswith(_LEGS)]
        messages = {
            OK: osc.message(OK, OK_TYPES, 0, 0, 0, 0),
            TIME: osc.message(TIME, TIME_TYPES, 0.0),
        }
        if bones:
            messages[ROOT] = _pose_message(ROOT, "root")
        head = list(messages)
        messages |= {bone: _pose_message(BONE, unity_name(bone)) for bone in bones}
        numbers_at: dict[str, _Place] = {}
        self.datagrams: list[bytearray] = []
        for run in _runs(([*head, *rest], legs), messages, bundling):
            data, offsets = osc.bundle([messages[name] for name in run])
            if bundling == "off":
                alone = messages[run[0]]
                data, offsets = bytearray(alone.dgram), (osc.numbers_offset(alone),)
            self.datagrams.append(data)
            numbers_at |= {name: (data, at) for name, at in zip(run, offsets, strict=True)}
        self._ok_at, self._time_at = numbers_at[OK], numbers_at[TIME]
        self._poses_at = [numbers_at[name] for name in ([ROOT, *bones] if bones else ())]

    def pose(self, numbers: Sequence[Numbers]) -> None:
        """Overwrite root and bones, in the order of `bones`."""
        for (data, at), row in zip(self._poses_at, numbers, strict=True):
            _pose_numbers.pack_into(data, at, *row)

    def say(self, loaded: bool, calibration: int, tracking: bool, time_s: float) -> None:
        """Overwrite OK and T; calibration: VMC's state, 3 when calibrated."""
        _ok_numbers.pack_into(*self._ok_at, loaded, calibration, 0, tracking)
        _time_number.pack_into(*self._time_at, time_s)


def _pose_message(address: str, name: str) -> OscMessage:
    return osc.message(address, POSE_TYPES, name, *(0.0,) * 6, 1.0)


def _runs(
    groups: Sequence[list[str]], messages: dict[str, OscMessage], bundling: Bundling
) -> Iterator[list[str]]:
    """The messages of each datagram, by name."""
    if bundling == "one":
        yield [name for group in groups for name in group]
        return
    for group in groups:
        run: list[str] = []
        for name in group:
            size = osc.bundle_size([messages[member] for member in (*run, name)])
            if run and (bundling == "off" or size > osc.MAX_DATAGRAM_BYTES):
                yield run
                run = []
            run.append(name)
        if run:
            yield run
