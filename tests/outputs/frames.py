"""Frames and helpers that the output tests share."""

import os
import socket
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import count

import numpy as np

from mocapd.body.skeleton import INDEX, joint_positions, rest_pose, standard_skeleton
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.wire import SCHEMA, Joint, SkeletonFrame
from mocapd.types import BodyState, Floats, Pose, Skeleton, Tracking

CAPTURE_NS = 5_000_000_123
UNIX_OFFSET_NS = 1_700_000_000_000_000_000
PUBLISH_NS = CAPTURE_NS + 15_625_000  # 1/64 s later, exact in a float32

HALF = 0.5

_FIRST_PORT, _PORTS = 10_000, 20_000
_NUMBERS = count(97 * os.getpid())


def small_frame(**changes: object) -> SkeletonFrame:
    """Two joints of numbers that are exact in float32: left arm up, by hand and not by mocapd."""
    fields: dict[str, object] = {
        "schema": SCHEMA,
        "instance": "pc",
        "person": 0,
        "seq": 7,
        "capture_monotonic_ns": CAPTURE_NS,
        "capture_unix_ns": CAPTURE_NS + UNIX_OFFSET_NS,
        "publish_monotonic_ns": PUBLISH_NS,
        "tracker": "colour",
        "tracking": "live",
        "cameras": ("left", "right"),
        "joints": {
            "hips": Joint((0.25, 1.0, -0.5), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0), 1.0),
            "leftUpperArm": Joint(
                (0.5, 1.5, -0.5), (0.0, 0.0, 0.75, 0.625), (HALF, HALF, HALF, HALF), 0.125
            ),
        },
    }
    return SkeletonFrame(**(fields | changes))  # type: ignore[arg-type]


def left_hand_up() -> tuple[BodyState, Skeleton]:
    """Facing +Z, left arm straight up, right arm as in the T-pose, right knee bent backwards."""
    skeleton = standard_skeleton(1.75)
    quats_xyzw = rest_pose(skeleton).quats_xyzw.copy()
    for name in ("leftUpperArm", "leftLowerArm", "leftHand"):
        quats_xyzw[INDEX[name]] = rotations.exp(np.array([0.0, 0.0, np.pi / 2]))
    for name in ("rightLowerLeg", "rightFoot", "rightToes"):
        quats_xyzw[INDEX[name]] = rotations.exp(np.array([np.pi / 2, 0.0, 0.0]))
    pose = Pose(skeleton.rest_m[0] + np.array([0.3, 0.0, -0.4]), quats_xyzw)
    confidence = np.linspace(0.0, 1.0, len(skeleton.names))
    body = BodyState(
        CAPTURE_NS,
        Tracking.LIVE,
        "colour",
        pose,
        joint_positions(skeleton, pose),
        confidence,
        ("left", "right"),
        uncertainty_m=uncertainties_m(skeleton.names),
    )
    return body, skeleton


def uncertainties_m(names: Sequence[str]) -> Floats:
    """Another of each joint, in tenths of a millimetre as it is sent; of the shins and below nothing is known."""
    below = [name.endswith(("LowerLeg", "Foot", "Toes")) for name in names]
    return np.where(below, np.inf, 0.0101 + 0.01 * np.arange(len(names)))


def whole_frame(seq: int = 0) -> SkeletonFrame:
    """All 22 joints of `left_hand_up`."""
    body, skeleton = left_hand_up()
    return skeleton_frame(
        body,
        skeleton,
        instance="pc",
        seq=seq,
        publish_monotonic_ns=PUBLISH_NS,
        unix_from_monotonic_ns=UNIX_OFFSET_NS,
    )


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """A port of 127.0.0.1 that nobody has, and that nobody is given until it is used.

    Each once, of those that the system itself gives to no connection; another process of tests begins
    elsewhere.
    """
    for number in _NUMBERS:
        port = _FIRST_PORT + number % _PORTS
        with socket.socket(socket.AF_INET, kind) as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise AssertionError


def eventually(holds: Callable[[], bool], within_s: float = 120.0) -> bool:
    """Whether it holds before the time is over."""
    deadline_s = time.monotonic() + within_s
    while not holds():
        if time.monotonic() > deadline_s:
            return False
        time.sleep(0.01)
    return True
