"""Make the golden packets of mocapd's own OSC anew: `python -m tests.golden.make_osc`.

The datagrams of the pose in `stepping_left` and of a frame that is lost, one file each, as they go
over the wire, and beside them `osc_joints.json`: what a receiver must make of them.
"""

import json
from pathlib import Path

import msgspec

from mocapd.outputs.osc.osc_frame import FrameBundles
from mocapd.outputs.wire import SkeletonFrame
from tests.golden import stepping_left

FOLDER = Path(__file__).parent / "osc"
JOINTS = FOLDER / "osc_joints.json"
UNIX_S = 1_700_000_000  # when the pose was captured


def whole() -> SkeletonFrame:
    """The pose, at a time of Unix as daemons have it."""
    frame = stepping_left.frame()
    at_ns = frame.capture_unix_ns + UNIX_S * 1_000_000_000
    return msgspec.structs.replace(frame, capture_unix_ns=at_ns, cameras=("left", "right"))


def lost() -> SkeletonFrame:
    """The frame after it, in which nobody is seen."""
    frame = whole()
    later = {name: getattr(frame, name) + 33_000_000 for name in _TIMES}
    return msgspec.structs.replace(frame, seq=frame.seq + 1, tracking="lost", joints={}, **later)


_TIMES = ("capture_monotonic_ns", "capture_unix_ns", "publish_monotonic_ns")
FRAMES = {"whole": whole, "lost": lost}


def datagrams(frame: SkeletonFrame) -> list[bytes]:
    """As they are sent."""
    return [bytes(one) for one in FrameBundles(frame).fill(frame)]


def kept(name: str) -> list[bytes]:
    """Those of `whole` or `lost`, from their files."""
    return [path.read_bytes() for path in sorted(FOLDER.glob(f"{name}_*.osc"))]


def joints_json() -> str:
    """Of each joint, by VRM 1.0 name: position [m], rotation in the world and relative to the bone above, x y z w."""
    joints = whole().joints
    told = {
        name: {"p_m": one.p, "global_xyzw": one.r, "local_xyzw": one.l}
        for name, one in joints.items()
    }
    rounded = {
        name: {key: [round(value, 6) for value in values] for key, values in one.items()}
        for name, one in told.items()
    }
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(one)}" for name, one in rounded.items())
    return f"{{\n{lines}\n}}\n"


def main() -> None:
    """Write the files."""
    FOLDER.mkdir(exist_ok=True)
    for name, frame in FRAMES.items():
        for number, datagram in enumerate(datagrams(frame())):
            (FOLDER / f"{name}_{number:02}.osc").write_bytes(datagram)
    JOINTS.write_text(joints_json())


if __name__ == "__main__":
    main()
