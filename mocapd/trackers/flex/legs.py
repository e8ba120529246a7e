"""Two legs look alike: when each has slipped onto the other, they are exchanged."""

from dataclasses import replace

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, PARENTS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.types import Floats

_CROSSED_M = 0.03  # by which the left ankle is to the right of the right one
LEG_BONES = ("UpperLeg", "LowerLeg", "Foot")


def are_crossed(joints_m: Floats) -> bool:
    """Whether the ankles of joints (J,3) lie the other way round than the hip joints, seen from above."""
    across = joints_m[INDEX["leftUpperLeg"]] - joints_m[INDEX["rightUpperLeg"]]
    across[1] = 0.0
    length = float(np.linalg.norm(across))
    ankles = joints_m[INDEX["leftFoot"]] - joints_m[INDEX["rightFoot"]]
    return length > 1e-3 and float(ankles @ across) / length < -_CROSSED_M


def with_legs_exchanged(fitter: Fitter, state: MotionState) -> MotionState:
    """Each leg pointed where the other one points, so that the ankles change places but for the width of the hips."""
    _, globals_ = fitter.joints(state)
    local = state.local_xyzw.copy()
    for side, other in (SIDES, SIDES[::-1]):
        for bone in LEG_BONES:
            i, j = INDEX[side + bone], INDEX[other + bone]
            local[i] = rotations.multiply(rotations.inverse(globals_[PARENTS[j]]), globals_[j])
    return replace(state, local_xyzw=local, velocity=np.zeros_like(state.velocity))
