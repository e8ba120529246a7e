"""A pelvis that is twisted against trunk and legs, while its hip joints were seen elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.pelvis_heading import PelvisHeadingParams, turned_pelvis
from tests.tracking.hypotheses.test_keypoint_poses import seen_at
from tests.tracking.hypotheses.test_limb_swap import FITTER, standing

pytestmark = pytest.mark.kernels

PARAMS = PelvisHeadingParams()
HIP_JOINTS = np.array([INDEX["leftUpperLeg"], INDEX["rightUpperLeg"]])
REST = [
    INDEX[name]
    for name in ("neck", "leftHand", "leftLowerLeg", "leftFoot", "leftToes", "rightToes")
]


def with_pelvis_turned(state: MotionState, rad: float) -> MotionState:
    """The pelvis alone: spine and thighs turn back."""
    local, back = state.local_xyzw.copy(), rotations.exp(np.array([0.0, -rad, 0.0]))
    local[0] = rotations.multiply(rotations.exp(np.array([0.0, rad, 0.0])), local[0])
    third = rotations.exp(np.array([0.0, -rad / 3.0, 0.0]))
    for name in ("spine", "chest", "upperChest"):
        local[INDEX[name]] = rotations.multiply(third, local[INDEX[name]])
    for joint in HIP_JOINTS:
        local[joint] = rotations.multiply(back, local[joint])
    return replace(state, local_xyzw=rotations.canonical(local))


def test_a_pelvis_is_turned_to_its_hip_joints_and_the_rest_stays() -> None:
    twisted = with_pelvis_turned(standing(0.3, 0.1), 2.0)
    there_m, before_m = FITTER.joints(standing(0.3, 0.1))[0], FITTER.joints(twisted)[0]
    state = turned_pelvis(FITTER, twisted, seen_at(there_m, HIP_JOINTS), PARAMS)
    assert state is not None
    after_m = FITTER.joints(state)[0]
    assert np.abs(after_m[HIP_JOINTS] - there_m[HIP_JOINTS]).max() < 0.02
    assert np.abs(after_m[REST] - before_m[REST]).max() < 0.06  # a leg begins elsewhere now


def test_a_pelvis_that_faces_as_it_was_seen_is_left() -> None:
    there_m = FITTER.joints(standing(0.3, 0.1))[0]
    slightly = with_pelvis_turned(standing(0.3, 0.1), 0.5)
    assert turned_pelvis(FITTER, slightly, seen_at(there_m, HIP_JOINTS), PARAMS) is None
