"""Two arms look alike: seen from the side one may have slipped onto the other, and each is tried where the other one is."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import PARENTS
from mocapd.fit.limbs.arm_samples import Arm
from mocapd.fit.limbs.reaching import poses_to
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.types import Floats


def with_arms_exchanged(fitter: Fitter, state: MotionState, arms: Mapping[str, Arm]) -> MotionState:
    """Each hand where the other one is, or as near as it reaches, with the elbow beside the other's; arms: both, by side."""
    joints_m, globals_ = fitter.joints(state)
    local = state.local_xyzw.copy()
    for side, its in (SIDES, SIDES[::-1]):
        arm, other = arms[side], arms[its]
        chain = arm.chain[:3]
        poses = poses_to(
            joints_m[other.chain[3:4]], joints_m, globals_, arm, state.local_xyzw[chain]
        )
        elbows_m = _elbows(poses, arm, joints_m, globals_)
        nearest = np.linalg.norm(elbows_m - joints_m[other.chain[2]], axis=1).argmin()
        local[chain] = poses[nearest]
    return replace(state, local_xyzw=local, velocity=np.zeros_like(state.velocity))


def _elbows(poses_xyzw: Floats, arm: Arm, joints_m: Floats, globals_xyzw: Floats) -> Floats:
    """Where poses (N,3,4) of an arm with its present collar have the elbow (N,3)."""
    collar, upper, elbow = arm.chain[:3]
    fixed = rotations.multiply(globals_xyzw[PARENTS[collar]], poses_xyzw[:, 0])
    present = rotations.inverse(globals_xyzw[upper])
    along: Floats = rotations.rotate(present, joints_m[elbow] - joints_m[upper])
    placed: Floats = joints_m[upper] + rotations.rotate(
        rotations.multiply(fixed, poses_xyzw[:, 1]), along
    )
    return placed
