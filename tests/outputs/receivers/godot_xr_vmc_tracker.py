"""GodotXRVmcTracker, the VMC add-on of Godot 4: bones only, one connection, a pose per datagram.

Re-implements Malcolmnixon/GodotXRVmcTracker
`addons/godot_vmc_tracker/{osc_reader,vmc_source,vmc_body}.gd`: tags other than i f s b add no
value and do not move on; Root/Pos, OK and T are ignored, so that travel must be in Hips;
positions and rotations are chained from Hips, and a bone that was never told is at zero; z is
turned round. A datagram from a new port makes that THE connection, and the old one is read no
more.
"""

import struct

from tests.outputs.receivers.humanoid import ORIGIN, PARENT_OF, Transform, Vector, chained

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
