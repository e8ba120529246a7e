"""A recorded session of the demo's person: shaking as tracked poses do, late, and lost for a moment."""

from pathlib import Path

import msgspec
import numpy as np

from goalkeeper.streams.demo_script import LOOP_S, demo_scenario
from mocapd.clock import NS_PER_S
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.wire import SkeletonFrame
from mocapd.sim.world import World
from mocapd.types import BodyState, Tracking

SESSION_S = 90.0
RATE_HZ = 30.0
LATENCY_NS = 45_000_000
SHAKE_M = 0.006
BEGAN_NS = 5 * NS_PER_S
UNIX_NS = 1_700_000_000 * NS_PER_S


def session_frames(seconds: float, lost_s: tuple[float, float] = (0.0, 0.0)) -> list[SkeletonFrame]:
    """Frames of so long; nobody is tracked between the two times of `lost_s`."""
    world = World(demo_scenario())
    rng = np.random.default_rng(3)
    loop = [world.at(i / RATE_HZ) for i in range(round(min(seconds, LOOP_S) * RATE_HZ))]
    out = []
    for number in range(round(seconds * RATE_HZ)):
        truth = loop[number % len(loop)]
        lost = lost_s[0] <= number / RATE_HZ < lost_s[1]
        joints_m = truth.joints_m + rng.normal(0.0, SHAKE_M, truth.joints_m.shape)
        t_ns = BEGAN_NS + round(number / RATE_HZ * NS_PER_S)
        body = BodyState(
            t_ns,
            Tracking.LOST if lost else Tracking.LIVE,
            "shirt",
            None if lost else truth.pose,
            None if lost else joints_m,
            np.full(len(joints_m), 0.0 if lost else 1.0),
        )
        frame = skeleton_frame(
            body,
            world.skeleton,
            instance="pc",
            seq=number,
            publish_monotonic_ns=t_ns + LATENCY_NS,
            unix_from_monotonic_ns=UNIX_NS,
        )
        out.append(frame)
    return out


def write_session(path: Path, frames: list[SkeletonFrame]) -> Path:
    """As `mocapd record` writes it."""
    rest = rest_skeleton(World(demo_scenario()).skeleton, instance="pc", stature_m=1.75)
    with RecordingWriter(path, RecordingParams(foxglove_hz=0.0), 0) as writer:
        writer.add_state(rest, frames[0].capture_unix_ns)
        for frame in frames:
            writer.frame(frame)
            writer.flush_if_due(frame.capture_unix_ns)
    return path


def record_session(path: Path, seconds: float) -> Path:
    """A session in which nobody is lost."""
    return write_session(path, session_frames(seconds))


def without_left_hand(frame: SkeletonFrame) -> SkeletonFrame:
    """The left hand is not known."""
    joints = {name: joint for name, joint in frame.joints.items() if name != "leftHand"}
    return msgspec.structs.replace(frame, joints=joints)
