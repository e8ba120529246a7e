"""Limbs that three cameras see elsewhere are laid there; of fewer, none is said to be elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry import rotations
from mocapd.tracking.cues.keypoints.limbs_at_keypoints import (
    limbs_off_crossings,
    with_limbs_at_keypoints,
)
from mocapd.types import Floats
from tests.tracking.initialisers.test_first_pose_all_around import CAMERAS, FITTER
from tests.tracking.initialisers.test_keypoint_pose import seen_by
from tests.tracking.initialisers.test_standing_initialiser import BODY, turned

pytestmark = pytest.mark.kernels

ARM = [INDEX["leftLowerArm"], INDEX["leftHand"]]


def with_left_arm(state: MotionState, up_rad: float, bent_rad: float) -> MotionState:
    local = state.local_xyzw.copy()
    local[INDEX["leftUpperArm"]] = rotations.exp(np.array([0.0, 0.0, up_rad]))
    local[INDEX["leftLowerArm"]] = rotations.exp(np.array([0.0, bent_rad, 0.0]))
    return replace(state, local_xyzw=local)


def seen(joints_m: Floats, cameras: int) -> JointTerm:
    return JointTerm(BODY, [seen_by(camera, joints_m) for camera in CAMERAS[:cameras]])


def test_an_arm_that_was_found_folded_is_laid_where_it_is_stretched() -> None:
    true, folded = with_left_arm(turned(0.7), 0.3, -0.2), with_left_arm(turned(0.7), 0.2, -2.4)
    true_m, folded_m = FITTER.joints(true)[0], FITTER.joints(folded)[0]
    keypoints = seen(true_m, 3)
    assert limbs_off_crossings(keypoints, true_m) == []
    assert limbs_off_crossings(keypoints, folded_m) == ["left_arm"]
    laid = with_limbs_at_keypoints(FITTER, folded, keypoints, ["left_arm"])
    assert np.linalg.norm(FITTER.joints(laid)[0] - true_m, axis=1).max() < 0.02
    assert limbs_off_crossings(seen(true_m, 2), folded_m) == []
