"""One Gauss-Newton step without evidence: priors alone."""

from dataclasses import replace

import numpy as np

from mocapd.body.arrays import plain
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.priors.pose_prior import wide_baseline_prior
from mocapd.fit.solve_kernels import gauss_newton_step
from mocapd.fit.view import View
from mocapd.geometry import rotations
from tests.fit.synthetic import fitter, standing

_NO_PIXEL = np.zeros((120, 160), np.uint8)
NOTHING_SEEN = View(0, (80, 60, 240, 180), _NO_PIXEL, _NO_PIXEL, 0.0)  # nor denied
WIDE = np.array([[-1.0], [1.0]])  # room for a step


def leaning(pitch_rad: float, roll_rad: float, yaw_rad: float) -> MotionState:
    state = standing("hanging", "hanging", yaw_rad)
    local = state.local_xyzw.copy()
    lean = rotations.exp(np.array([pitch_rad, 0.0, roll_rad]))
    local[0] = rotations.multiply(lean, local[0])
    return replace(state, local_xyzw=local)


def lean_rad(state: MotionState) -> float:
    up = rotations.rotate(state.local_xyzw[0], np.array([0.0, 1.0, 0.0]))
    return float(np.arccos(np.clip(up[1], -1.0, 1.0)))


def test_before_one_camera_a_body_of_which_nothing_is_seen_stands_up_slowly() -> None:
    by = fitter(1, FitParams(tilt_sd_rad=0.25))
    for yaw_rad in (0.0, 1.2, -2.5):
        before = leaning(0.3, -0.2, yaw_rad)
        after = by.fit(before, [NOTHING_SEEN], 1 / 30, 1).state
        assert lean_rad(after) < lean_rad(before) - 0.01
        turned = rotations.log(
            rotations.multiply(after.local_xyzw[0], rotations.inverse(before.local_xyzw[0]))
        )
        assert abs(turned[1]) < 0.2 * np.linalg.norm(turned)


def test_where_nothing_is_seen_the_prediction_is_held_by_what_is_known_of_it() -> None:
    by, before = fitter(1), leaning(0.0, 0.0, 0.0)
    firm = 1e6 * np.eye(by.model.n_pose)
    held = by.fit(before, [], 1 / 30, 3, motion=firm).state
    np.testing.assert_allclose(held.local_xyzw, before.local_xyzw, atol=1e-4)
    loose = by.fit(before, [], 1 / 30, 3).state
    assert np.abs(loose.local_xyzw - before.local_xyzw).max() > 1e-3


def test_a_size_that_another_depth_explains_as_well_teaches_no_proportion() -> None:
    model, state = fitter(1).model, standing("hanging", "hanging", 0.0)
    priors, firm = plain(wide_baseline_prior(model, FitParams())), 1e3 * np.eye(model.n_pose)
    known = initial_information(model.space)
    rows = np.zeros((2, model.n_pose + model.n_shape))
    rows[0, [2, model.n_pose]] = 1.0  # how large it looks: nearer, or a longer torso
    rows[1, model.n_pose + 1] = 1.0  # the breadth of its shoulders, whatever the pose
    H, b = 1e4 * rows.T @ rows, 1e4 * rows.T @ np.array([0.2, 0.05])
    step = gauss_newton_step(
        H, b, state.root_m, state.local_xyzw, state.root_m, state.local_xyzw, firm, priors,
        np.zeros(model.n_shape), known, WIDE * np.ones((1, model.n_shape)),
    )  # fmt: skip
    torso, shoulders = step[model.n_pose : model.n_pose + 2]
    assert abs(torso) < 1e-3 < 0.04 < shoulders
    np.testing.assert_allclose(step[2], 0.2 * 1e4 / (1e4 + 1e3), rtol=0.01)


def test_nobody_is_of_other_proportions_than_people_are() -> None:
    model, state = fitter(1).model, standing("hanging", "hanging", 0.0)
    priors, loose = plain(wide_baseline_prior(model, FitParams())), np.eye(model.n_pose)
    rows = np.zeros((1, model.n_pose + model.n_shape))
    rows[0, [2, model.n_pose]] = 1.0
    H, b = 1e6 * rows.T @ rows, 1e6 * rows.T @ np.array([0.5])
    certain = 1e9 * np.eye(model.n_shape)  # that the torso is longer by 0.4
    offset = np.zeros(model.n_shape)
    offset[0] = 0.4
    step = gauss_newton_step(
        H, b, state.root_m, state.local_xyzw, state.root_m, state.local_xyzw, loose, priors,
        offset, certain, 0.1 * WIDE * np.ones((1, model.n_shape)),
    )  # fmt: skip
    np.testing.assert_allclose(step[model.n_pose], 0.1)
    np.testing.assert_allclose(step[2], 0.4, rtol=0.01)  # the pose explains the rest


def test_one_camera_has_a_line_of_sight_to_the_body_and_several_have_a_depth() -> None:
    by, state = fitter(2), standing("hanging", "hanging", 0.0)
    camera = by.drawings[1].camera
    ray = by.line_of_sight(state, {1: 0.0})
    assert ray is not None
    np.testing.assert_allclose(np.linalg.norm(ray), 1.0)
    away_m = state.root_m + camera.R.T @ camera.t_m
    np.testing.assert_allclose(np.cross(ray, away_m), 0.0, atol=1e-9)
    assert ray @ away_m > 0.0
    assert by.line_of_sight(state, {0: 0.0, 1: 0.0}) is None
