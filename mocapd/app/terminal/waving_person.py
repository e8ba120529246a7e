"""A test person for outputs with distinguishable sides: waves the left hand, steps to its left and back."""

import numpy as np

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, global_from_local, joint_positions, local_from_global
from mocapd.clock import seconds
from mocapd.geometry import rotations
from mocapd.pipeline.body_hub import BodySample
from mocapd.trackers.canned.canned_motion import CannedMotion
from mocapd.trackers.canned.tracker import UNCERTAINTY_M, canned_pose
from mocapd.tracking.base import Track
from mocapd.types import BodyState, Floats, FrameSet, Pose, Tracking

LOOP = CannedMotion(loop_s=4.0, waves=6, sway_m=0.25)  # to the left in its first second
_LIFT_DEG = 35.0  # of the thigh; the shin twice as far the other way


def waving_person(shape: BodyShape, since_start_ns: int, now_ns: int) -> BodySample:
    """The person's body at a time after the start, stamped with `now_ns`."""
    skeleton = skeleton_of(shape)
    canned = canned_pose(skeleton, LOOP, since_start_ns)
    local_xyzw = local_from_global(skeleton, canned.quats_xyzw)
    to_left = np.cos(2.0 * np.pi * seconds(since_start_ns) / LOOP.loop_s)  # how fast, 1 at most
    for side, share in (("left", max(0.0, to_left)), ("right", max(0.0, -to_left))):
        local_xyzw[INDEX[f"{side}UpperLeg"]] = _about_x(-_LIFT_DEG * share)
        local_xyzw[INDEX[f"{side}LowerLeg"]] = _about_x(2.0 * _LIFT_DEG * share)
    pose = Pose(canned.root_m, global_from_local(skeleton, local_xyzw))
    joints_m = joint_positions(skeleton, pose)
    confidence = np.ones(len(skeleton.names))
    body = BodyState(
        now_ns,
        Tracking.LIVE,
        "canned",
        pose,
        joints_m,
        confidence,
        uncertainty_m=UNCERTAINTY_M * confidence,
    )
    return BodySample(Track(body, shape, quality=1.0), skeleton, FrameSet(now_ns, {}))


def _about_x(angle_deg: float) -> Floats:
    return rotations.exp(np.radians([angle_deg, 0.0, 0.0]))
