"""What Godot 4 makes of an XRBodyTracker: XRBodyModifier3D on a skeleton of SkeletonProfileHumanoid.

Re-implements `scene/3d/xr/xr_body_modifier_3d.cpp` of godotengine/godot: a bone is driven relative to
the joint of its parent bone, or to the root joint; joints that are not valid are passed over; by
rotation only, all but the hips keep their place. The axes are those of the reference poses in
`scene/resources/skeleton_profile.cpp`, which a retargeted import gives every avatar.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats
from tests.outputs.receivers.humanoid import PARENT_OF

ROOT = "Root"
VALID = 1 | 4  # orientation and position
_UNIT = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}

# Columns of each bone's rotation relative to its parent bone in the reference pose; else as the parent's
_RELATIVE = {
    "LeftShoulder": "+Z +X +Y", "LeftUpperArm": "-X +Y -Z", "LeftLowerArm": "+Z +Y -X", "LeftHand": "-Z +Y +X",
    "RightShoulder": "-Z -X +Y", "RightUpperArm": "-X +Y -Z", "RightLowerArm": "-Z +Y +X", "RightHand": "+Z +Y -X",
    **{
        side + bone: columns
        for side in ("Left", "Right")
        for bone, columns in (
            ("UpperLeg", "-X -Y +Z"), ("LowerLeg", "-X +Y -Z"), ("Foot", "-X -Z -Y"), ("Toes", "-X +Y -Z"),
        )
    },
}  # fmt: skip


@dataclass(frozen=True)
class XrJoint:
    """A joint of an XRBodyTracker, absolute in tracking space; `basis` (3,3) has the axes as columns."""

    origin_m: Floats
    basis: Floats
    flags: int


def columns(words: str) -> Floats:
    """`-X +Y -Z` to the matrix with these columns."""
    signed = [
        np.array(_UNIT[word[1]]) * (-1.0 if word[0] == "-" else 1.0) for word in words.split()
    ]
    return np.array(signed).T


def reference_axes(bones: Mapping[str, Floats]) -> dict[str, Floats]:
    """Of each bone in the reference pose: its axes in the skeleton's space, where a person faces +Z."""
    axes: dict[str, Floats] = {}
    for bone in PARENT_OF:
        if bone in bones:
            above = PARENT_OF[bone]
            parent = axes.get(above, np.eye(3)) if above else np.eye(3)
            axes[bone] = parent @ columns(_RELATIVE.get(bone, "+X +Y +Z"))
    return axes


def driven(
    joints: Mapping[str, XrJoint],
    offsets_m: Mapping[str, Floats],
    *,
    rotation_only: bool,
    motion_scale: float = 1.0,
) -> dict[str, Floats]:
    """Where an avatar's joints come to be in tracking space [m]: an XRNode3D above it stands at the root joint.

    `offsets_m`: of each bone its place relative to its parent's in the T-pose, facing +Z; of the hips from the floor.
    """
    at_rest = reference_axes(offsets_m)
    root = joints[ROOT]
    assert root.flags & VALID == VALID  # else nothing is driven at all
    poses: dict[str, tuple[Floats, Floats]] = {}
    for bone, axes in at_rest.items():
        above = PARENT_OF[bone]
        parent_axes = at_rest[above] if above else np.eye(3)
        origin_m, basis = parent_axes.T @ offsets_m[bone], parent_axes.T @ axes
        joint = joints.get(bone)
        if joint is not None and joint.flags & VALID == VALID:
            parent = joints[above] if above else root
            turn = parent.basis.T
            moved_m = turn @ (joint.origin_m - parent.origin_m) * motion_scale
            if not rotation_only or bone == "Hips":
                origin_m = moved_m
            basis = turn @ joint.basis
        above_at_m, above_turn = poses[above] if above else (root.origin_m, root.basis)
        poses[bone] = (above_at_m + above_turn @ origin_m, above_turn @ basis)
    return {bone: at_m for bone, (at_m, _) in poses.items()}
