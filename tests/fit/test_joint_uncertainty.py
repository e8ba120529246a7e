"""How uncertain each joint is: against numeric differences, against drawn poses, and as a fit of pictures tells it."""

import numpy as np
import pytest

from mocapd.body.model import BodyModel, build_model
from mocapd.body.pose_space import full_body
from mocapd.body.posing_kernels import forward_kinematics
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.joint_uncertainty import (
    joint_jacobian_m,
    joint_uncertainty_m,
    pose_covariance,
)
from mocapd.fit.motion_state import apply_step
from mocapd.types import Floats
from tests.body.random_poses import random_local, random_root
from tests.fit.synthetic import STATURE_M, fitter, standing, views_of

UPPER, WHOLE = build_model(STATURE_M), build_model(STATURE_M, full_body())
LEAST_M = 0.005  # no joint is told to be known better
MODELS = pytest.mark.parametrize("model", [UPPER, WHOLE], ids=["upper", "whole"])
LEGS_BELOW_THE_HIPS = [
    INDEX[side + bone] for side in ("left", "right") for bone in ("LowerLeg", "Foot", "Toes")
]


def posed(model: BodyModel, root_m: Floats, local_xyzw: Floats) -> tuple[Floats, Floats]:
    """Joints (J,3) and global rotations (J,4)."""
    R, joints_m, quats = (
        np.empty((N_JOINTS, 3, 3)),
        np.empty((N_JOINTS, 3)),
        np.empty((N_JOINTS, 4)),
    )
    forward_kinematics(model.parents, model.rest_m, root_m, local_xyzw, R, joints_m, quats)
    return joints_m, quats


def some_covariance(n: int, seed: int) -> Floats:
    """Of a pose step, with correlations: about a centimetre and a degree or two."""
    mixed = np.random.default_rng(seed).normal(size=(n, n)) / np.sqrt(n)
    covariance: Floats = 0.02**2 * (mixed @ mixed.T)
    return covariance


@MODELS
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_jacobian_is_that_of_numeric_differences(model: BodyModel, seed: int) -> None:
    root_m, local = random_root(seed), random_local(seed)
    found = joint_jacobian_m(model, *posed(model, root_m, local))
    step = 1e-6
    for p in range(model.n_pose):
        ahead, behind = (
            posed(model, *apply_step(model, root_m, local, sign * step * np.eye(model.n_pose)[p]))[
                0
            ]
            for sign in (1.0, -1.0)
        )
        assert found[:, :, p] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-7)


@MODELS
def test_it_is_the_spread_of_poses_that_are_drawn(model: BodyModel) -> None:
    root_m, local = random_root(5), random_local(5)
    covariance = some_covariance(model.n_pose, 7)
    told_m = joint_uncertainty_m(model, *posed(model, root_m, local), covariance)
    steps = np.random.default_rng(11).multivariate_normal(np.zeros(model.n_pose), covariance, 4000)
    drawn_m = np.stack([posed(model, *apply_step(model, root_m, local, step))[0] for step in steps])
    spread_m = np.hypot(np.sqrt(drawn_m.var(axis=0).mean(axis=1)), LEAST_M)
    moved = np.isfinite(told_m)
    moved[INDEX["head"]] = model is WHOLE  # in the smaller space its neck is not drawn
    assert moved.sum() >= 15
    assert told_m[moved] == pytest.approx(spread_m[moved], rel=0.05)


def test_of_bones_that_are_not_looked_at_nothing_is_known_below() -> None:
    body = posed(UPPER, random_root(1), random_local(1))
    told_m = joint_uncertainty_m(UPPER, *body, some_covariance(UPPER.n_pose, 2))
    assert np.isinf(told_m[LEGS_BELOW_THE_HIPS]).all()
    assert np.isfinite(np.delete(told_m, LEGS_BELOW_THE_HIPS)).all()
    # a nod moves the head by a few centimetres, however well the shoulders are known
    known_m = joint_uncertainty_m(UPPER, *body, np.zeros((UPPER.n_pose, UPPER.n_pose)))
    assert known_m[INDEX["neck"]] == LEAST_M
    assert 0.01 < known_m[INDEX["head"]] < 0.06


def test_a_second_camera_and_a_look_at_an_arm_make_it_smaller() -> None:
    def told_m(n_cameras: int, left: str) -> Floats:
        by = fitter(n_cameras)
        state = standing(left=left)
        fit = by.fit(state, views_of(by, state), 1.0 / 30.0, 3)
        covariance = pose_covariance(by.model, fit.H)
        return joint_uncertainty_m(by.model, *by.joints(fit.state), covariance)

    one, two = told_m(1, "goalpost"), told_m(2, "goalpost")
    seen = np.isfinite(two)
    assert (two[seen] < one[seen]).all()
    assert two[INDEX["hips"]] < 0.03
    assert two[INDEX["leftHand"]] < 0.05
    behind = told_m(1, "behind_back")
    assert behind[INDEX["leftHand"]] > 1.7 * one[INDEX["leftHand"]]
    nothing = joint_uncertainty_m(
        UPPER,
        *posed(UPPER, random_root(1), random_local(1)),
        pose_covariance(UPPER, np.zeros((27, 27))),
    )
    assert nothing[INDEX["leftHand"]] > 0.3, "a hand that no picture shows may be anywhere in reach"
