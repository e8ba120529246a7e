"""Left-right swap of the arms: in a side view one arm may slip onto the other."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.fit.limbs.arm_samples import Arm
from mocapd.fit.limbs.hand_target_poses import bones_to_rotations, limb_bones_to
from mocapd.fit.limbs.limb_fits import with_limb
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter


def with_arms_exchanged(fitter: Fitter, state: MotionState, arms: Mapping[str, Arm]) -> MotionState:
    """Each hand where the other one is, or as near as it reaches, with the elbow near the other's; arms: both, by side."""
    joints_m, globals_ = fitter.joints(state)
    exchanged = replace(state, velocity=np.zeros_like(state.velocity))
    for side, its in (SIDES, SIDES[::-1]):
        arm, other = arms[side], arms[its]
        shoulder, chain = joints_m[arm.chain[1]], arm.chain[:3]
        elbow, hand = joints_m[other.chain[2:4]]
        upper, lower = (bone[:, 0] for bone in limb_bones_to(hand[None], joints_m, globals_, arm))
        nearest = [np.linalg.norm(shoulder + upper - elbow, axis=1).argmin()]
        poses = bones_to_rotations(
            upper[nearest], lower[nearest], joints_m, globals_, arm, state.local_xyzw[chain]
        )
        exchanged = with_limb(exchanged, arm, poses[0])
    return exchanged
