"""Visibility of limbs, and a motion without the limbs that no camera saw: their pose is the tracker's guess."""

from collections.abc import Collection
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from mocapd.exports.sampled_motion import SampledMotion
from mocapd.types import Skeleton

LEAST_CONFIDENCE = 0.1  # of a joint in a frame; below, the tracker had almost no evidence
_LEAST_SHARE = 0.05  # of the frames; a limb visible in fewer counts as unseen
_WHOLE_SHARE = 0.95  # of the frames; a limb visible in more needs no remark
LIMBS = MappingProxyType(
    {
        f"{side} {limb}": tuple(f"{side}{bone}" for bone in bones)
        for limb, bones in (
            ("leg", ("UpperLeg", "LowerLeg", "Foot", "Toes")),
            ("arm", ("UpperArm", "LowerArm", "Hand")),
        )
        for side in ("left", "right")
    }
)


def visible_shares(motion: SampledMotion) -> dict[str, float]:
    """By limb of LIMBS in the skeleton: the share of frames with a person in which it is visible. Ignores the limb's
    last joint, the least certain one."""
    names, tracked = motion.skeleton.names, motion.gap == 0
    shares = {}
    for limb, bones in LIMBS.items():
        if all(bone in names for bone in bones) and tracked.any():
            joints = [names.index(bone) for bone in bones[1:3]]
            visible = motion.confidence[tracked][:, joints] >= LEAST_CONFIDENCE
            shares[limb] = float(visible.all(axis=1).mean())
    return shares


def unseen_legs(motion: SampledMotion) -> tuple[str, ...]:
    """Names of the legs that count as unseen."""
    shares = visible_shares(motion)
    return tuple(limb for limb, share in shares.items() if "leg" in limb and share < _LEAST_SHARE)


def visibility_text(motion: SampledMotion) -> str:
    """For the user, which share of the limbs' poses is a guess; empty where all are visible almost always."""
    parts = [
        f"the {limb} in {100.0 * share:.0f} %"
        for limb, share in visible_shares(motion).items()
        if share < _WHOLE_SHARE
    ]
    return (
        f"seen in the frames with a person: {', '.join(parts)}; the rest is guessed"
        if parts
        else ""
    )


def without_joints(motion: SampledMotion, left_out: Collection[str]) -> SampledMotion:
    """The motion of the other joints. With a joint, all its descendants must be left out, too."""
    names, parents = motion.skeleton.names, motion.skeleton.parents
    remaining = [joint for joint, name in enumerate(names) if name not in left_out]
    index = {joint: number for number, joint in enumerate(remaining)} | {-1: -1}
    skeleton = Skeleton(
        tuple(names[joint] for joint in remaining),
        np.array([index[int(parents[joint])] for joint in remaining], dtype=np.int64),
        motion.skeleton.rest_m[remaining],
    )
    return replace(
        motion,
        skeleton=skeleton,
        joints_m=motion.joints_m[:, remaining],
        global_xyzw=motion.global_xyzw[:, remaining],
        confidence=motion.confidence[:, remaining],
        uncertainty_m=motion.uncertainty_m[:, remaining],
    )
