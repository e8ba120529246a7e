"""The asymmetric pose of the golden packets: facing forward, left hand up, stepping to the left."""

import numpy as np

from mocapd.body.skeleton import INDEX, global_from_local, joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import rest_skeleton
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import BodyState, Pose, Skeleton, Tracking

STATURE_M = 1.75
CAPTURE_NS = 5_000_000_123
HIPS_M = (0.35, 0.94, -0.2)  # to the left of the origin, lowered by the step, a little behind

# Rotations relative to the bone above [degrees], about x (forward over), y (to the left), z (left arm up)
LOCAL_DEG = {
    "hips": (3.0, 8.0, -4.0), "spine": (6.0, -2.0, 5.0), "chest": (2.0, 4.0, 3.0), "upperChest": (-3.0, 5.0, 2.0),
    "neck": (5.0, -6.0, 0.0), "head": (-8.0, 10.0, 4.0),
    "leftShoulder": (0.0, 0.0, 15.0), "leftUpperArm": (0.0, -10.0, 60.0), "leftLowerArm": (0.0, -20.0, 12.0),
    "leftHand": (10.0, 0.0, 5.0),
    "rightUpperArm": (10.0, 15.0, 62.0), "rightLowerArm": (0.0, 35.0, 0.0), "rightHand": (0.0, 0.0, -8.0),
    "leftUpperLeg": (-12.0, 5.0, 24.0), "leftLowerLeg": (18.0, 0.0, 0.0), "leftFoot": (-4.0, 0.0, -12.0),
    "leftToes": (-6.0, 0.0, 0.0),
    "rightUpperLeg": (4.0, -3.0, -6.0), "rightLowerLeg": (9.0, 0.0, 0.0), "rightToes": (12.0, 0.0, 0.0),
}  # fmt: skip


def body() -> tuple[BodyState, Skeleton]:
    """The person, of mean proportions."""
    skeleton = standard_skeleton(STATURE_M)
    local_xyzw = np.tile(rotations.IDENTITY_XYZW, (len(skeleton.names), 1))
    for name, turn_deg in LOCAL_DEG.items():
        local_xyzw[INDEX[name]] = rotations.exp(np.radians(turn_deg))
    pose = Pose(np.array(HIPS_M), global_from_local(skeleton, local_xyzw))
    joints_m = joint_positions(skeleton, pose)
    confidence = np.ones(len(skeleton.names))
    state = BodyState(
        CAPTURE_NS,
        Tracking.LIVE,
        "canned",
        pose,
        joints_m,
        confidence,
        (),
        uncertainty_m=np.linspace(0.01, 0.031, len(skeleton.names)),
    )
    return state, skeleton


def frame() -> SkeletonFrame:
    """As it is sent."""
    state, skeleton = body()
    return skeleton_frame(
        state,
        skeleton,
        instance="golden",
        seq=0,
        publish_monotonic_ns=CAPTURE_NS,
        unix_from_monotonic_ns=0,
    )


def rest() -> RestSkeleton:
    """The T-pose that is told before."""
    return rest_skeleton(body()[1], instance="golden", stature_m=STATURE_M)
