"""A leg that is turned about its length so that its toes point elsewhere than they were seen."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.foot_heading import FootHeadingParams, legs_with_turned_feet
from tests.tracking.hypotheses.standing_body import BODY, FITTER, standing
from tests.tracking.hypotheses.test_keypoint_poses import seen_at

pytestmark = pytest.mark.kernels

PARAMS = FootHeadingParams()
FEET = np.array([INDEX[side + bone] for side in ("left", "right") for bone in ("Foot", "Toes")])


def with_leg_turned(state: MotionState, rad: float) -> MotionState:
    """The left leg, which hangs down, turned about its length."""
    local = state.local_xyzw.copy()
    thigh = INDEX["leftUpperLeg"]
    local[thigh] = rotations.multiply(local[thigh], rotations.exp(np.array([0.0, rad, 0.0])))
    return replace(state, local_xyzw=local)


def test_a_foot_that_points_backwards_is_turned_to_where_its_toes_were_seen() -> None:
    truth = standing(0.0, 0.15)
    there_m = FITTER.joints(truth)[0]
    (found,) = legs_with_turned_feet(
        FITTER, with_leg_turned(truth, 2.6), seen_at(there_m, FEET), PARAMS
    )
    state, changed = found
    assert changed == ("left_leg",)
    assert np.abs(FITTER.joints(state)[0][FEET] - there_m[FEET]).max() < 0.03


def test_feet_that_point_as_they_were_seen_are_left() -> None:
    there_m = FITTER.joints(standing(0.0, 0.15))[0]
    slightly = with_leg_turned(standing(0.0, 0.15), 0.5)
    assert not list(legs_with_turned_feet(FITTER, slightly, seen_at(there_m, FEET), PARAMS))


def test_one_camera_alone_does_not_say_where_toes_point() -> None:
    both = seen_at(FITTER.joints(standing(0.0, 0.15))[0], FEET)
    seen = JointTerm(BODY, both.rays[:1])
    assert np.isinf(seen.crossings[1]).all()
    assert not list(
        legs_with_turned_feet(FITTER, with_leg_turned(standing(0.0, 0.15), 2.6), seen, PARAMS)
    )


def test_rays_of_two_cameras_cross_at_the_joint() -> None:
    there_m = FITTER.joints(standing(0.0, 0.15))[0]
    places_m, sd_m = seen_at(there_m, FEET).crossings
    assert places_m[FEET] == pytest.approx(there_m[FEET], abs=1e-4)
    assert (sd_m[FEET] < 0.3).all()
    assert np.isinf(np.delete(sd_m, FEET)).all()
