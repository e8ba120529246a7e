"""A person who turns and walks as exactly as numbers can, as frames."""

from collections.abc import Callable, Mapping

import numpy as np

from mocapd.body.skeleton import INDEX, global_from_local, joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import BodyState, Floats, Pose, Tracking

SKELETON = standard_skeleton(1.75)
UNIX_NS = 1_700_000_000_000_000_000

Turns = Callable[[float], Mapping[str, Floats]]


def frame_at(
    t_s: float, turns_rad: Turns, walked_m: Callable[[float], Floats], confidence: float = 1.0
) -> SkeletonFrame:
    """At time t_s. turns_rad: each bone's rotation vector relative to its parent; walked_m: of the hips."""
    vectors = np.zeros((len(SKELETON.names), 3))
    for name, vector in turns_rad(t_s).items():
        vectors[INDEX[name]] = vector
    pose = Pose(
        SKELETON.rest_m[0] + walked_m(t_s), global_from_local(SKELETON, rotations.exp(vectors))
    )
    t_ns = round(t_s * 1e9)
    sure = np.full(len(SKELETON.names), confidence)
    joints_m = joint_positions(SKELETON, pose)
    body = BodyState(t_ns, Tracking.LIVE, "canned", pose, joints_m, sure, ("left",))
    return skeleton_frame(
        body,
        SKELETON,
        instance="pc",
        seq=round(30 * t_s),
        publish_monotonic_ns=t_ns,
        unix_from_monotonic_ns=UNIX_NS,
    )


def swinging(t_s: float) -> Mapping[str, Floats]:
    """Both arms and the trunk, smoothly, at speeds of sport."""
    swing = np.sin(2.0 * np.pi * 0.8 * t_s)
    return {
        "spine": np.array([0.0, 0.3 * swing, 0.0]),
        "leftUpperArm": np.array([0.2, 0.9 * swing, 0.4]),
        "leftLowerArm": np.array([0.0, 0.6 + 0.5 * swing, 0.0]),
        "rightUpperArm": np.array([0.5 * swing, 0.0, -0.8]),
    }


def walking(t_s: float) -> Floats:
    return np.array([0.9 * t_s, 0.0, 0.3 * np.sin(3.0 * t_s)])


def distance_m(a: SkeletonFrame, b: SkeletonFrame, name: str) -> float:
    return float(np.linalg.norm(np.subtract(a.joints[name].p, b.joints[name].p)))
