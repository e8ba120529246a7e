"""One body of two: the upper body that one tracker sees, on the legs and under the head that another sees."""

from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.types import BodyState, Floats, Pose, Skeleton

TRUNK = np.array([INDEX[name] for name in ("hips", "spine", "chest", "upperChest", "neck")])
# Bones whose rotations are the other's, and joints whose places follow from those.
LOWER_BONES = np.array(
    [INDEX[n] for n in ("neck", "head")]
    + [INDEX[s + n] for s in ("left", "right") for n in ("UpperLeg", "LowerLeg", "Foot", "Toes")]
)
LOWER_JOINTS = np.setdiff1d(LOWER_BONES, [INDEX["neck"]])  # the shirt ends at the neck


def apart_m(one: BodyState, other: BodyState) -> float:
    """How far two bodies' trunks are from each other, on average of their joints [m]; infinite without a body."""
    if one.joints_m is None or other.joints_m is None:
        return float("inf")
    return float(np.linalg.norm(one.joints_m[TRUNK] - other.joints_m[TRUNK], axis=1).mean())


def placed(body: BodyState, skeleton: Skeleton) -> BodyState:
    """The body with the joints that its pose gives a wearer of this skeleton."""
    if body.pose is None:
        return body
    return replace(body, joints_m=joint_positions(skeleton, body.pose))


def joined(upper: BodyState, lower: BodyState, skeleton: Skeleton) -> BodyState:
    """Where `upper` is and how it moves, with the legs, neck and head of `lower` as that has them in the world; both
    have a pose. Confidence and uncertainty of each joint are those of who sees it."""
    assert upper.pose is not None
    assert lower.pose is not None
    quats = _with(upper.pose.quats_xyzw, lower.pose.quats_xyzw, LOWER_BONES)
    pose = Pose(upper.pose.root_m, quats)
    return replace(
        upper,
        tracker=f"{upper.tracker}+{lower.tracker}",
        pose=pose,
        joints_m=joint_positions(skeleton, pose),
        confidence=_with(upper.confidence, lower.confidence, LOWER_JOINTS),
        uncertainty_m=_with(upper.uncertainty_m, lower.uncertainty_m, LOWER_JOINTS),
        cameras=tuple(dict.fromkeys(upper.cameras + lower.cameras)),
    )


def _with(one: Floats, other: Floats, rows: Floats) -> Floats:
    out = one.copy()
    out[rows] = other[rows]
    return out
