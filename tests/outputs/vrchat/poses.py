"""An asymmetric person as the daemon sends it: left hand up, facing forward or turned, stepping left."""

import numpy as np

from mocapd.body.skeleton import INDEX, global_from_local, joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import BodyState, Floats, Pose, Tracking

SKELETON = standard_skeleton(1.75)


def stepping_left(
    *, yaw_deg: float = 0.0, at_m: tuple[float, float] = (0.3, -0.4), now_ns: int = 0,
    confidence: Floats | None = None, head_yaw_deg: float = 0.0, live: bool = True,
) -> SkeletonFrame:  # fmt: skip
    """Standing there (x, z), turned to its left by `yaw_deg`, the head by so much more."""
    local = np.tile(rotations.IDENTITY_XYZW, (len(SKELETON.names), 1))

    def turn(bone: str, x_deg: float, y_deg: float, z_deg: float) -> None:
        local[INDEX[bone]] = rotations.exp(np.radians([x_deg, y_deg, z_deg]))

    turn("hips", 0.0, yaw_deg, 0.0)
    turn("head", 10.0, head_yaw_deg, 0.0)
    turn("chest", 5.0, 0.0, -8.0)
    turn("leftUpperArm", 0.0, 0.0, 80.0)
    turn("rightUpperArm", 0.0, 30.0, 60.0)
    turn("leftUpperLeg", -20.0, 5.0, 35.0)
    turn("leftLowerLeg", 40.0, 0.0, 0.0)
    turn("leftFoot", 0.0, 25.0, 0.0)
    root_m = np.array([at_m[0], SKELETON.rest_m[0, 1], at_m[1]])
    pose = Pose(root_m, global_from_local(SKELETON, local))
    known = np.ones(len(SKELETON.names)) if confidence is None else confidence
    joints_m = joint_positions(SKELETON, pose)
    tracking = Tracking.LIVE if live else Tracking.LOST
    body = BodyState(now_ns, tracking, "canned", pose, joints_m, known, ("cam0",))
    return skeleton_frame(
        body, SKELETON, instance="pc", seq=0, publish_monotonic_ns=now_ns, unix_from_monotonic_ns=0
    )


def known_but(value: float, *bones: str) -> Floats:
    """A confidence of 1 for all joints but these."""
    out = np.ones(len(SKELETON.names))
    out[[INDEX[name] for name in bones]] = value
    return out


def of_the_shirt(trunk: float = 0.9) -> Floats:
    """As a tracker of the shirt has it: the head follows, with half the confidence of the trunk; of legs it knows nothing."""
    legs = [name for name in SKELETON.names if name.endswith(("Leg", "Foot", "Toes"))]
    return trunk * known_but(0.5, "head") * known_but(0.0, *legs)
