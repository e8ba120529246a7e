"""Limbs that were seen elsewhere: tried there, in pictures classified beside that pose, left where those deny it."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, OTHER_SIDE
from mocapd.fit.fit_params import LegSearchParams, LimbSearchParams
from mocapd.fit.limbs.arm_search import ArmSearch
from mocapd.fit.limbs.leg_search import LegSearch
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointRays, JointTerm, JointTermParams
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import to_camera
from mocapd.tracking.cues.clothes.region_merge import RegionSolvers
from mocapd.tracking.cues.keypoints.limbs_at_keypoints import limbs_off_crossings
from mocapd.tracking.hypotheses.base import HypothesisContext, PoseEvidence, ScoredFit
from mocapd.tracking.hypotheses.keypoint_poses import (
    KeypointPoseParams,
    KeypointPoses,
    keypoint_starts,
    legs_exchanged,
)
from mocapd.tracking.ticks import Ticks
from mocapd.types import Floats, Ints
from tests.tracking.hypotheses.standing_body import BODY, FITTER, drawn, standing

pytestmark = pytest.mark.kernels

PARAMS = KeypointPoseParams(whole_cost=1e9)  # limbs alone
DT_S = 1.0 / 30.0
LIMBS = np.array([INDEX[s + j] for s in ("left", "right") for j in ("LowerArm", "Hand", "LowerLeg", "Foot")])  # fmt: skip
HAND, FOOT = INDEX["leftHand"], INDEX["leftFoot"]


TRUNK = np.array([INDEX[s + j] for s in ("left", "right") for j in ("UpperArm", "UpperLeg")])


def seen_at(joints_m: Floats, which: Ints = LIMBS) -> JointTerm:
    """Both cameras see elbows, hands, knees and feet there, or other joints."""
    out = []
    for drawing in FITTER.drawings:
        there = to_camera(drawing.camera, joints_m)[which]
        n = len(which)
        hips_z = to_camera(drawing.camera, joints_m)[0, 2]
        out.append(
            JointRays(
                drawing.camera, which, there[:, :2] / there[:, 2:], np.tile([400.0, 0.0, 400.0], (n, 1)),
                there[:, 2] - hips_z, np.full(n, 100.0),
            )
        )  # fmt: skip
    return JointTerm(BODY, out)


def with_arm(state: MotionState, rad: float) -> MotionState:
    local = state.local_xyzw.copy()
    local[INDEX["leftUpperArm"]] = rotations.exp(np.array([0.0, 0.0, rad]))
    return replace(state, local_xyzw=local)


def kicking(state: MotionState, side: str) -> MotionState:
    local = state.local_xyzw.copy()
    local[INDEX[side + "UpperLeg"]] = rotations.exp(np.array([-1.2, 0.0, 0.0]))
    return replace(state, local_xyzw=local)


def situation(joints: JointTerm, evidence: PoseEvidence) -> HypothesisContext:
    solvers = RegionSolvers(
        FITTER, ArmSearch(FITTER, LimbSearchParams()), LegSearch(FITTER, LegSearchParams())
    )
    return HypothesisContext(solvers, DT_S, Ticks(1, 1, 1), (joints,), evidence)


def nobody(state: MotionState) -> list[View]:
    return [replace(view, ids=np.zeros_like(view.ids)) for view in drawn(state)]


@pytest.mark.parametrize("shown", [drawn, nobody])
def test_a_limb_goes_where_it_was_seen_unless_pictures_of_that_pose_deny_it(
    shown: Callable[[MotionState], list[View]],
) -> None:
    here, there = with_arm(standing(0.0, 0.1), -1.3), with_arm(standing(0.0, 0.1), 0.7)
    goal_m = FITTER.joints(there)[0]
    joints = seen_at(goal_m)
    views = drawn(here)
    fit = FITTER.fit(here, views, DT_S, 2, rendered=True, terms=(joints,))

    def measured(_: MotionState, __: Sequence[View]) -> Sequence[Term]:
        return (joints,)

    now = ScoredFit(fit, views, (joints,))
    found = KeypointPoses(PARAMS).test(now, situation(joints, PoseEvidence(shown, measured)))
    off_m = np.linalg.norm(FITTER.joints(found.fit.state)[0][HAND] - goal_m[HAND])
    if shown is drawn:
        assert found.changed == ("left_arm",)
        assert off_m < 0.15
    else:
        assert found.fit is fit
        assert found.changed == ()
        assert off_m > 0.5


def test_a_limb_goes_where_it_was_seen_though_another_was_seen_where_it_is_not() -> None:
    here = with_arm(standing(0.0, 0.1), -1.3)
    true = with_arm(here, 0.7)
    joints = seen_at(FITTER.joints(kicking(true, "right"))[0])
    fit = FITTER.fit(here, drawn(true), DT_S, 2)
    now = ScoredFit(fit, drawn(true), (joints,))
    evidence = PoseEvidence(lambda _: drawn(true), lambda _, __: (joints,))
    found = KeypointPoses(PARAMS).test(now, situation(joints, evidence))
    assert found.changed == ("left_arm",)
    off_m = np.linalg.norm(FITTER.joints(found.fit.state)[0] - FITTER.joints(true)[0], axis=1)
    assert off_m[HAND] < 0.15
    assert off_m[INDEX["rightFoot"]] < 0.25


def test_three_cameras_that_agree_have_a_limb_tried_where_their_rays_cross_though_it_costs_little() -> (
    None
):
    here = with_arm(standing(0.0, 0.1), -1.3)
    true = with_arm(here, 0.7)
    seen = seen_at(FITTER.joints(true)[0])
    rays = [*seen.rays, seen.rays[0]]
    fit = FITTER.fit(here, drawn(here), DT_S, 1)
    for cameras, tried in ((2, []), (3, ["left_arm"])):
        joints = JointTerm(BODY, rays[:cameras], JointTermParams(weight=0.1, depth_weight=0.0))
        assert limbs_off_crossings(joints, FITTER.joints(fit.state)[0]) == tried
        starts = keypoint_starts(FITTER, fit, joints, (), PARAMS, at_crossings=True)
        assert [changed for _, changed in starts] == [(name,) for name in tried]
    off_m = np.linalg.norm(FITTER.joints(starts[0][0])[0] - FITTER.joints(true)[0], axis=1)
    assert off_m[HAND] < 0.05


def test_where_limbs_are_as_they_were_seen_nothing_is_tried() -> None:
    here = standing(0.0, 0.1)
    fit = FITTER.fit(here, drawn(here), DT_S, 1)
    now = ScoredFit(fit, drawn(here), ())
    seen = seen_at(FITTER.joints(fit.state)[0])
    at = situation(seen, PoseEvidence(drawn, lambda _, __: ()))
    assert KeypointPoses(PARAMS).test(now, at) is now


def with_legs_of_the_other_side(joints_m: Floats) -> Floats:
    out = joints_m.copy()
    legs = [INDEX[s + j] for s in ("left", "right") for j in ("UpperLeg", "LowerLeg", "Foot")]
    out[legs] = joints_m[OTHER_SIDE[legs]]
    return out


def test_legs_that_are_taken_for_each_other_are_no_reason_to_move_them() -> None:
    here = kicking(standing(0.0, 0.1), "left")
    here_m = FITTER.joints(here)[0]
    taken_m = with_legs_of_the_other_side(here_m)
    fit = FITTER.fit(here, drawn(here), DT_S, 1)
    for seen_m, exchanged in (
        (here_m, False),
        (taken_m, True),
        (FITTER.joints(standing(0.0, 0.1))[0], False),
    ):
        seen = seen_at(seen_m)
        joints_m = FITTER.joints(fit.state)[0]
        assert legs_exchanged(seen, joints_m, seen.costs(joints_m), PARAMS) is exchanged
    starts = keypoint_starts(FITTER, fit, seen_at(taken_m), (), PARAMS)
    assert starts == []


def test_where_the_upper_body_is_known_legs_are_tried_as_seen_unless_the_trunk_is_seen_turned_too() -> (
    None
):
    here = kicking(standing(0.0, 0.1), "left")
    fit = FITTER.fit(here, drawn(here), DT_S, 1)
    here_m = FITTER.joints(fit.state)[0]
    legs_m = with_legs_of_the_other_side(here_m)
    ((start, changed), *_) = keypoint_starts(
        FITTER, fit, seen_at(legs_m), (), PARAMS, legs_alone=True
    )
    assert set(changed) == {"left_leg", "right_leg"}
    found_m = FITTER.joints(start)[0]
    assert np.linalg.norm(found_m[OTHER_SIDE[FOOT]] - here_m[FOOT]) < 0.3  # hips stay
    turned_m = legs_m.copy()
    turned_m[TRUNK] = here_m[OTHER_SIDE[TRUNK]]
    both = seen_at(turned_m, np.concatenate([TRUNK, LIMBS]))
    assert keypoint_starts(FITTER, fit, both, (), PARAMS, legs_alone=True) == []


def test_a_leg_that_was_seen_elsewhere_is_tried_there() -> None:
    here, there = standing(0.0, 0.1), kicking(standing(0.0, 0.1), "left")
    fit = FITTER.fit(here, drawn(here), DT_S, 1)
    goal_m = FITTER.joints(there)[0]
    ((start, changed), *_) = keypoint_starts(FITTER, fit, seen_at(goal_m), (), PARAMS)
    assert changed == ("left_leg",)
    assert np.linalg.norm(FITTER.joints(start)[0][FOOT] - goal_m[FOOT]) < 0.15


def test_keypoints_that_see_a_body_face_the_other_way_are_believed_at_the_third_look() -> None:
    """Its colours were learned from the reversed body, so pictures confirm that one."""
    here = standing(0.0, 0.1)
    views = drawn(here)
    seen = seen_at(FITTER.joints(standing(np.pi, 0.1))[0], np.concatenate([TRUNK, LIMBS]))
    fit = FITTER.fit(here, views, DT_S, 2, rendered=True, terms=(seen,))
    at = situation(seen, PoseEvidence(lambda _: drawn(here), lambda _, __: (seen,)))
    poses = KeypointPoses(KeypointPoseParams())
    changed = [poses.test(ScoredFit(fit, views, (seen,)), at).changed for _ in range(3)]
    assert changed == [(), (), ("whole",)]
