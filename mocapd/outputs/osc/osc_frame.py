"""The native OSC address space: a skeleton frame as bundles.

Every bundle begins with `/mocapd/v1/frame`; its joints follow as `/mocapd/v1/joint/<VRM name>`.
A frame that does not fit one datagram is split into several of nearly equal size. Long strings
are cut, so that a header and one joint always fit.
"""

import struct
from itertools import pairwise

from pythonosc.osc_message import OscMessage

from mocapd.outputs.osc import osc_template as osc
from mocapd.outputs.wire import SkeletonFrame

FRAME = "/mocapd/v1/frame"
FRAME_TYPES = "iiiiiiifssss"
FRAME_ARGUMENTS = (
    ("person", "i", "number of the person"),
    ("seq", "i", "counts the frames, modulo 2^31"),
    ("part", "i", "which bundle of the frame this is, from 0"),
    ("parts", "i", "how many bundles the frame has"),
    ("joints", "i", "how many joints the whole frame has; 0 when lost"),
    ("capture_s", "i", "capture time, whole seconds of Unix time, unsigned"),
    ("capture_ns", "i", "capture time, nanoseconds within the second"),
    ("latency_s", "f", "capture to publish [s]"),
    ("tracking", "s", "`live`, `coasting` or `lost`"),
    ("tracker", "s", "which tracker"),
    ("cameras", "s", "cameras whose evidence was used, joined by commas"),
    ("instance", "s", "name of the sending daemon"),
)
JOINT = "/mocapd/v1/joint/"
JOINT_TYPES = "f" * 13
JOINT_ARGUMENTS = (
    ("px py pz", "fff", "position in the world [m]"),
    ("rx ry rz rw", "ffff", "global rotation relative to the T-pose, w >= 0"),
    ("lx ly lz lw", "ffff", "rotation relative to the parent bone, w >= 0"),
    ("c", "f", "confidence 0..1"),
    (
        "u",
        "f",
        "one standard deviation of the position, root mean square over x, y and z [m]; -1: unknown",
    ),
)
# UTF-8 that is sent of each string [bytes]; with a joint, at most 812 of a datagram's 1472
MAX_TRACKING_BYTES = 32
MAX_TRACKER_BYTES = 64
MAX_CAMERAS_BYTES = 200
MAX_INSTANCE_BYTES = 256  # 64 characters
MAX_JOINT_BYTES = 64

_frame_numbers = struct.Struct(">iiiiiIIf")  # the arguments before the strings
_joint_numbers = struct.Struct(">13f")
_UNKNOWN = -1.0  # not infinity: some receivers crash on it

Shape = tuple[str, str, tuple[str, ...], str, tuple[str, ...]]


def shape_of(frame: SkeletonFrame) -> Shape:
    """The key of a bundle layout: a frame's strings and its joints' names."""
    return frame.tracking, frame.tracker, frame.cameras, frame.instance, tuple(frame.joints)


class FrameBundles:
    """The bundles for frames of one shape: built once, the numbers overwritten per frame."""

    def __init__(self, frame: SkeletonFrame, limit_bytes: int = osc.MAX_DATAGRAM_BYTES) -> None:
        header = osc.message(
            FRAME,
            FRAME_TYPES,
            *(0, 0, 0, 0, 0, 0, 0, 0.0),
            osc.truncate_utf8(frame.tracking, MAX_TRACKING_BYTES),
            osc.truncate_utf8(frame.tracker, MAX_TRACKER_BYTES),
            osc.truncate_utf8(",".join(frame.cameras), MAX_CAMERAS_BYTES),
            osc.truncate_utf8(frame.instance, MAX_INSTANCE_BYTES),
        )
        joints = [_joint_message(name) for name in frame.joints]
        self._bundles: list[tuple[bytearray, int, tuple[int, ...]]] = []
        for run in _runs(joints, header, limit_bytes):
            data, (header_at, *joints_at) = osc.bundle([header, *run])
            self._bundles.append((data, header_at, tuple(joints_at)))

    def fill(self, frame: SkeletonFrame) -> list[bytearray]:
        """The datagrams of a frame of this shape; they are overwritten by the next call."""
        second, nanosecond = divmod(frame.capture_unix_ns, 1_000_000_000)
        latency_s = (frame.publish_monotonic_ns - frame.capture_monotonic_ns) * 1e-9
        joints = iter(frame.joints.values())
        for part, (data, frame_at, joints_at) in enumerate(self._bundles):
            _frame_numbers.pack_into(
                data,
                frame_at,
                frame.person,
                frame.seq & 0x7FFFFFFF,
                part,
                len(self._bundles),
                len(frame.joints),
                second & 0xFFFFFFFF,
                nanosecond,
                latency_s,
            )
            # not strict: each bundle takes its share of the joints from the common iterator
            for offset, joint in zip(joints_at, joints, strict=False):
                u = _UNKNOWN if joint.u is None else joint.u
                _joint_numbers.pack_into(data, offset, *joint.p, *joint.r, *joint.l, joint.c, u)
        return [data for data, _, _ in self._bundles]


def _joint_message(name: str) -> OscMessage:
    address = JOINT + osc.truncate_utf8(name, MAX_JOINT_BYTES)
    return osc.message(address, JOINT_TYPES, *(0.0,) * len(JOINT_TYPES))


def _runs(joints: list[OscMessage], header: OscMessage, limit_bytes: int) -> list[list[OscMessage]]:
    """The fewest runs of joints, of nearly equal length, each of which fits with the header."""
    for count in range(1, max(len(joints), 1) + 1):
        cuts = [len(joints) * k // count for k in range(count + 1)]
        runs = [joints[a:b] for a, b in pairwise(cuts)]
        if all(osc.bundle_size([header, *run]) <= limit_bytes for run in runs):
            return runs
    raise ValueError(f"one joint and its header do not fit {limit_bytes} bytes")
