"""Which limbs were seen, and a motion without those that nobody saw: their pose is the tracker's guess."""

from collections.abc import Collection
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from mocapd.exports.sampled_motion import SampledMotion
from mocapd.types import Skeleton

LEAST_CONFIDENCE = 0.1  # of a joint in a frame; below, the tracker had next to no evidence
_LEAST_SHARE = 0.05  # of the frames, below which a limb counts as unseen
_WHOLE_SHARE = 0.95  # from which nothing is said
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


def seen_shares(motion: SampledMotion) -> dict[str, float]:
    """Of each limb of LIMBS that the skeleton has: in which share of the frames with a person it is seen, its last
    joint apart, which is the least certain."""
    names, tracked = motion.skeleton.names, motion.gap == 0
    shares = {}
    for limb, bones in LIMBS.items():
        if all(bone in names for bone in bones) and tracked.any():
            joints = [names.index(bone) for bone in bones[1:3]]
            seen = motion.confidence[tracked][:, joints] >= LEAST_CONFIDENCE
            shares[limb] = float(seen.all(axis=1).mean())
    return shares


def unseen_legs(motion: SampledMotion) -> tuple[str, ...]:
    """Names of the legs that count as unseen."""
    shares = seen_shares(motion)
    return tuple(limb for limb, share in shares.items() if "leg" in limb and share < _LEAST_SHARE)


def seen_text(motion: SampledMotion) -> str:
    """What of the limbs is guessed, for people; empty where all are seen nearly always."""
    parts = [
        f"the {limb} in {100.0 * share:.0f} %"
        for limb, share in seen_shares(motion).items()
        if share < _WHOLE_SHARE
    ]
    return (
        f"seen in the frames with a person: {', '.join(parts)}; the rest is guessed"
        if parts
        else ""
    )


def without_joints(motion: SampledMotion, left_out: Collection[str]) -> SampledMotion:
    """The motion of the other joints. What hangs on a joint that is left out must be left out, too."""
    names, parents = motion.skeleton.names, motion.skeleton.parents
    kept = [joint for joint, name in enumerate(names) if name not in left_out]
    place = {joint: number for number, joint in enumerate(kept)} | {-1: -1}
    skeleton = Skeleton(
        tuple(names[joint] for joint in kept),
        np.array([place[int(parents[joint])] for joint in kept], dtype=np.int64),
        motion.skeleton.rest_m[kept],
    )
    return replace(
        motion,
        skeleton=skeleton,
        joints_m=motion.joints_m[:, kept],
        global_xyzw=motion.global_xyzw[:, kept],
        confidence=motion.confidence[:, kept],
        uncertainty_m=motion.uncertainty_m[:, kept],
    )
