"""GodotXRVmcTracker, the VMC add-on of Godot 4: bones only, one connection, a pose per datagram.

Re-implements Malcolmnixon/GodotXRVmcTracker
`addons/godot_vmc_tracker/{osc_reader,vmc_source,vmc_body}.gd`: tags other than i f s b add no
value and do not move on; Root/Pos, OK and T are ignored, so that travel must be in Hips;
positions and rotations are chained from Hips, and a bone that was never told is at zero; z is
turned round. A datagram from a new port makes that THE connection, and the old one is read no
more. The XRBodyTracker gets joints with the axes of Godot's humanoid, no toes, every one flagged as
tracked, and a root under the hips; tracking data are there from the first bone on, for ever.
"""

import struct

import numpy as np

from mocapd.types import Floats
from tests.outputs.receivers.godot_xr_body import ROOT, XrJoint, columns
from tests.outputs.receivers.humanoid import (
    ORIGIN,
    PARENT_OF,
    Quaternion,
    Transform,
    Vector,
    chained,
    rotated,
)

_ALL_TRACKED = 1 | 2 | 4 | 8
# A joint's axes (the `roll` of its JOINT_MAPPING) on a person in the T-pose who faces -Z, the left at -X
_AXES = {
    **dict.fromkeys(("Hips", "Spine", "Chest", "UpperChest", "Neck", "Head"), "-X +Y -Z"),
    "LeftShoulder": "-Z -X +Y", "LeftUpperArm": "+Z -X -Y", "LeftLowerArm": "-Y -X -Z", "LeftHand": "+Z -X -Y",
    "RightShoulder": "+Z +X +Y", "RightUpperArm": "-Z +X -Y", "RightLowerArm": "+Y +X -Z", "RightHand": "-Z +X -Y",
    **{
        side + bone: axes
        for side in ("Left", "Right")
        for bone, axes in (("UpperLeg", "+X -Y -Z"), ("LowerLeg", "-X -Y +Z"), ("Foot", "+X -Z +Y"))
    },
}  # fmt: skip

Peer = tuple[str, int]
Value = int | float | str | bytes
Entry = list[Value]


class GodotXrVmcTracker:
    """`receive` takes a datagram and who sent it, and polls at once."""

    def __init__(self) -> None:
        self._peers: set[Peer] = set()
        self._connection: Peer | None = None
        self._bones: dict[str, Transform] = dict.fromkeys(PARENT_OF, ORIGIN)
        self.poses = 0  # how often the body was posed

    @property
    def has_tracking_data(self) -> bool:
        """Of the XRBodyTracker."""
        return self.poses > 0

    def tracker(self) -> dict[str, XrJoint]:
        """The XRBodyTracker's joints, as they are set, in its tracking space."""
        placed = chained(self._bones)
        joints = {
            bone: XrJoint(np.array(at_m), _matrix(turn) @ columns(_AXES[bone]), _ALL_TRACKED)
            for bone, (at_m, turn) in placed.items()
            if bone in _AXES
        }
        side, up = joints["Hips"].basis[:, 0], np.array([0.0, 1.0, 0.0])
        back = -np.cross(side, up)
        back /= np.linalg.norm(back)
        floor_m = joints["Hips"].origin_m * (1.0, 0.0, 1.0)
        heading = np.array([np.cross(up, back), up, back]).T
        return {ROOT: XrJoint(floor_m, heading, _ALL_TRACKED), **joints}

    def receive(self, datagram: bytes, peer: Peer = ("127.0.0.1", 50000)) -> None:
        """Taken only from the newest connection."""
        if peer not in self._peers:
            self._peers.add(peer)
            self._connection = peer
        if peer != self._connection:
            return
        entries: list[Entry] = []
        _OscReader(datagram).read(entries)
        new_joints = [self._bone(entry) for entry in entries if entry[0] == "/VMC/Ext/Bone/Pos"]
        self.poses += any(new_joints)

    def joints_m(self) -> dict[str, Vector]:
        """The XRBodyTracker's joints in mocapd's world. In Godot's tracking space a person faces -Z."""
        return {bone: (-x, y, -z) for bone, ((x, y, z), _) in chained(self._bones).items()}

    def _bone(self, entry: Entry) -> bool:
        if entry[1] not in PARENT_OF:
            return False
        # GDScript would take an int as a number here; a missing one is an error, which ends the function
        if len(entry) < 9 or not all(isinstance(value, int | float) for value in entry[2:9]):
            return False
        px, py, pz, qx, qy, qz, qw = (float(value) for value in entry[2:9])
        self._bones[str(entry[1])] = ((px, py, -pz), (qx, qy, -qz, -qw))
        return True


def _matrix(turn: Quaternion) -> Floats:
    units: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return np.array([rotated(turn, unit) for unit in units]).T


class _OscReader:
    """osc_reader.gd on a StreamPeerBuffer, which reads zeros behind its end."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def read(self, entries: list[Entry]) -> None:
        kind = self._data[self._at : self._at + 1]
        if kind == b"/":
            entries.append(self._message())
        elif kind == b"#":
            self._string()
            self._number(">q")
            while len(self._data) - self._at > 4:
                self._number(">i")
                self.read(entries)

    def _message(self) -> Entry:
        entry: Entry = [self._string()]
        for tag in self._string():
            match tag:
                case "i":
                    entry.append(int(self._number(">i")))
                case "f":
                    entry.append(self._number(">f"))
                case "s":
                    entry.append(self._string())
                case "b":
                    size = int(self._number(">i"))
                    entry.append(self._data[self._at : self._at + size])
                    self._at = (self._at + size + 3) & ~3
        return entry

    def _string(self) -> str:
        end = self._data.find(b"\0", self._at)
        if end < 0:
            return ""
        text = self._data[self._at : end].decode(errors="replace")
        self._at = (end + 4) & ~3
        return text

    def _number(self, form: str) -> float:
        size = struct.calcsize(form)
        (value,) = struct.unpack(form, self._data[self._at : self._at + size].ljust(size, b"\0"))
        self._at += size
        return value  # type: ignore[no-any-return]
