"""The VRM humanoid skeleton: proportions, forward kinematics, local and global rotations."""

import json
from functools import cache

import numpy as np

from mocapd.assets import asset_path
from mocapd.geometry import rotations
from mocapd.types import Floats, Pose, Skeleton

NAMES = (
    "hips", "spine", "chest", "upperChest", "neck", "head",
    "leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand",
    "leftUpperLeg", "leftLowerLeg", "leftFoot", "leftToes",
    "rightShoulder", "rightUpperArm", "rightLowerArm", "rightHand",
    "rightUpperLeg", "rightLowerLeg", "rightFoot", "rightToes",
)  # fmt: skip
PARENT_OF = {
    "spine": "hips", "chest": "spine", "upperChest": "chest", "neck": "upperChest", "head": "neck",
    "leftShoulder": "upperChest", "leftUpperArm": "leftShoulder", "leftLowerArm": "leftUpperArm",
    "leftHand": "leftLowerArm", "leftUpperLeg": "hips", "leftLowerLeg": "leftUpperLeg",
    "leftFoot": "leftLowerLeg", "leftToes": "leftFoot",
    "rightShoulder": "upperChest", "rightUpperArm": "rightShoulder", "rightLowerArm": "rightUpperArm",
    "rightHand": "rightLowerArm", "rightUpperLeg": "hips", "rightLowerLeg": "rightUpperLeg",
    "rightFoot": "rightLowerLeg", "rightToes": "rightFoot",
}  # fmt: skip
INDEX = {name: i for i, name in enumerate(NAMES)}
PARENTS = np.array([INDEX[PARENT_OF[n]] if n in PARENT_OF else -1 for n in NAMES], dtype=np.int64)
N_JOINTS = len(NAMES)


@cache
def mean_proportions() -> Floats:
    """T-pose joint centres (J,3) as fractions of stature, made symmetric about x = 0."""
    joints = json.loads(asset_path("body_proportions.json").read_text())["joints"]
    rest = np.array([joints[name]["mean"] for name in NAMES])
    mirror = np.array([INDEX[_other_side(name)] for name in NAMES])
    return 0.5 * (rest + rest[mirror] * np.array([-1.0, 1.0, 1.0]))


def _other_side(name: str) -> str:
    if name.startswith("left"):
        return "right" + name[4:]
    return "left" + name[5:] if name.startswith("right") else name


def standard_skeleton(stature_m: float) -> Skeleton:
    """The mean skeleton of a person of this stature."""
    return Skeleton(NAMES, PARENTS, mean_proportions() * stature_m)


def rest_pose(skeleton: Skeleton) -> Pose:
    """The T-pose, standing at the origin."""
    return Pose(skeleton.rest_m[0].copy(), np.tile(rotations.IDENTITY_XYZW, (len(skeleton.names), 1)))


def joint_positions(skeleton: Skeleton, pose: Pose) -> Floats:
    """Forward kinematics: joint centres (J,3) in the world [m]."""
    parents = skeleton.parents
    offsets = skeleton.rest_m - skeleton.rest_m[parents]
    turned = rotations.rotate(pose.quats_xyzw[parents], offsets)
    out = np.empty_like(skeleton.rest_m)
    out[0] = pose.root_m
    for j in range(1, len(parents)):
        out[j] = out[parents[j]] + turned[j]
    return out


def local_from_global(skeleton: Skeleton, global_xyzw: Floats) -> Floats:
    """Rotations (J,4) relative to the parent bone from global ones."""
    local = rotations.multiply(rotations.inverse(global_xyzw[skeleton.parents]), global_xyzw)
    local[0] = global_xyzw[0]
    return rotations.canonical(local)


def global_from_local(skeleton: Skeleton, local_xyzw: Floats) -> Floats:
    """Global rotations (J,4) from those relative to the parent bone."""
    out = np.array(local_xyzw, dtype=float)
    for j in range(1, len(skeleton.parents)):
        out[j] = rotations.multiply(out[skeleton.parents[j]], local_xyzw[j])
    return rotations.canonical(out)
