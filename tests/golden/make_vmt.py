"""Make the golden packets for SteamVR's driver VMT anew: `python -m tests.golden.make_vmt`.

The datagrams of the pose in `stepping_left`, one file each, as they go over the wire: in the room, below the headset, and of
a frame in which nobody is seen; and beside them `vmt_trackers.json`: where SteamVR must show each tracker.
"""

import json
import socket
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from mocapd.geometry import rotations
from mocapd.outputs.vmt.vmt_sink import Params, VmtSink
from mocapd.outputs.wire import SkeletonFrame
from tests.golden import stepping_left

FOLDER = Path(__file__).parent / "vmt"
TRACKERS = FOLDER / "vmt_trackers.json"
# VMT_<number>: joint where it is, bone that turns it
WORN = {
    1: ("hips", "hips"), 2: ("leftFoot", "leftFoot"), 3: ("rightFoot", "rightFoot"),
    4: ("leftLowerLeg", "leftUpperLeg"), 5: ("rightLowerLeg", "rightUpperLeg"), 6: ("upperChest", "upperChest"),
    7: ("leftLowerArm", "leftUpperArm"), 8: ("rightLowerArm", "rightUpperArm"),
}  # fmt: skip


def lost() -> SkeletonFrame:
    """The frame after the pose, in which nobody is seen."""
    frame = stepping_left.frame()
    at_ns = frame.publish_monotonic_ns + 33_000_000
    return msgspec.structs.replace(
        frame, seq=1, tracking="lost", joints={}, publish_monotonic_ns=at_ns
    )


def datagrams() -> dict[str, bytes]:
    """By the names of their files."""
    whole = stepping_left.frame()
    return {
        "room_00": _sent("room", whole),
        "headset_00": _sent("headset", whole),
        "lost_00": _sent("room", lost()),
    }


def kept() -> dict[str, bytes]:
    """The same from their files."""
    return {path.stem: path.read_bytes() for path in sorted(FOLDER.glob("*.osc"))}


def trackers_json() -> str:
    """Of each tracker in SteamVR's room: position [m] and rotation as a matrix's rows; computed apart from the output."""
    half_turn, joints = np.diag([-1.0, 1.0, -1.0]), stepping_left.frame().joints
    lines = []
    for number, (place, bone) in WORN.items():
        R = half_turn @ rotations.to_matrix(np.array(joints[bone].r)) @ half_turn
        told = {
            "p_m": (half_turn @ joints[place].p).round(6).tolist(),
            "rows": R.round(6).tolist(),
        }
        lines.append(f'  "VMT_{number}": {json.dumps(told)}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _sent(anchor: Literal["room", "headset"], frame: SkeletonFrame) -> bytes:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", 0))
        port = listening.getsockname()[1]
        sink = VmtSink(Params(f"127.0.0.1:{port}", anchor))
        sink.open()
        sink.send(frame)
        datagram = listening.recv(65536)
        sink.close()
    return datagram


def main() -> None:
    """Write the files."""
    FOLDER.mkdir(exist_ok=True)
    for name, datagram in datagrams().items():
        (FOLDER / f"{name}.osc").write_bytes(datagram)
    TRACKERS.write_text(trackers_json())


if __name__ == "__main__":
    main()
