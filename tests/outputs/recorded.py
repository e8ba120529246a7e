"""A moving asymmetric person, as frames: what the tests of recordings record."""

from pathlib import Path

import numpy as np

from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.clock import NS_PER_S
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_rig import calibration_info
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import BodyState, Pose, Rig, Tracking
from tests.geometry.rigs import ring
from tests.outputs.frames import CAPTURE_NS, UNIX_OFFSET_NS, uncertainties_m

HZ = 60.0
LATENCY_NS = 25_000_000
SKELETON = standard_skeleton(1.75)


def rest() -> RestSkeleton:
    """Told before the frames."""
    return rest_skeleton(SKELETON, instance="pc", stature_m=1.75)


def cameras() -> CalibrationInfo:
    """Two of them."""
    return calibration_info(Rig(ring(2)), instance="pc", source="rig.json")


def moving_body(t_s: float) -> BodyState:
    """Left hand up and waving, facing forward and turning a little, stepping left."""
    turn = rotations.exp(np.array([0.0, 0.4 * np.sin(t_s), 0.0]))
    quats_xyzw = np.tile(turn, (len(SKELETON.names), 1))
    raised = rotations.multiply(turn, rotations.exp(np.array([0.0, 0.0, 1.4])))
    waving = rotations.multiply(raised, rotations.exp(np.array([0.3 * np.sin(5 * t_s), 0.0, 0.5])))
    quats_xyzw[INDEX["leftUpperArm"]] = raised
    for name in ("leftLowerArm", "leftHand"):
        quats_xyzw[INDEX[name]] = waving
    bent = rotations.multiply(turn, rotations.exp(np.array([0.8, 0.1, 0.0])))
    for name in ("rightLowerLeg", "rightFoot"):
        quats_xyzw[INDEX[name]] = bent
    pose = Pose(
        SKELETON.rest_m[0] + np.array([0.3 * t_s, 0.02 * np.sin(6 * t_s), -0.4]),
        rotations.canonical(quats_xyzw),
    )
    return BodyState(
        CAPTURE_NS + round(t_s * NS_PER_S),
        Tracking.LIVE,
        "colour",
        pose,
        joint_positions(SKELETON, pose),
        np.linspace(0.0, 1.0, len(SKELETON.names)),
        ("cam0", "cam1"),
        uncertainty_m=uncertainties_m(SKELETON.names),
    )


def frame_at(t_s: float, seq: int) -> SkeletonFrame:
    """As it is published."""
    body = moving_body(t_s)
    return skeleton_frame(
        body,
        SKELETON,
        instance="pc",
        seq=seq,
        publish_monotonic_ns=body.t_ns + LATENCY_NS,
        unix_from_monotonic_ns=UNIX_OFFSET_NS,
    )


def frames(seconds: float, hz: float = HZ) -> list[SkeletonFrame]:
    """At a constant rate."""
    return [frame_at(number / hz, number) for number in range(round(seconds * hz))]


def record(path: Path, recorded: list[SkeletonFrame], **params: object) -> Path:
    """A recording of these frames, closed in order; a beat at each of them."""
    now_ns = recorded[0].capture_unix_ns if recorded else UNIX_OFFSET_NS
    with RecordingWriter(path, RecordingParams(**params), now_ns) as writer:  # type: ignore[arg-type]
        writer.add_state(cameras(), now_ns)
        writer.add_state(rest(), now_ns)
        for frame in recorded:
            writer.frame(frame)
            writer.flush_if_due(frame.capture_unix_ns)
    return path


def farthest_m(one: SkeletonFrame, other: SkeletonFrame) -> float:
    """How far a joint is from itself in the other frame at most [m]."""
    ours = np.array([joint.p for joint in one.joints.values()])
    theirs = np.array([other.joints[name].p for name in one.joints])
    return float(np.linalg.norm(ours - theirs, axis=1).max())
