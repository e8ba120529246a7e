"""What is known before a frame: the Kalman prediction from the last fit, and where arms are when nobody looks."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.priors.motion_prior import _HIDDEN_SD_RAD, predicted_information
from mocapd.fit.priors.pose_prior import load_arm_motion
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.fit.synthetic import MODEL, fitter, standing, views_of

N = MODEL.n_pose
ARM = {side: MODEL.space.columns(f"{side}_arm") for side in SIDES}
USUAL = fitter(1).prediction_sd


def information(
    covariance: Floats, step: Floats, left: float = 1.0, right: float = 1.0, frames: float = 1.0
) -> Floats:
    arms = [(ARM["left"], left), (ARM["right"], right)]
    return predicted_information(covariance, step, frames, USUAL, arms)


def spread(of: Floats) -> Floats:
    """Standard deviations (P,)."""
    return np.sqrt(np.diag(np.linalg.inv(of)))


def test_what_was_open_stays_open_and_what_was_known_is_held() -> None:
    sd = np.full(N, 1e-3)
    sd[2] = 0.08  # depth before one camera
    sd_now = spread(information(np.diag(sd**2), np.zeros(N)))
    assert sd_now[2] > 0.5 * sd[2]
    assert sd_now[0] == pytest.approx(sd_now[1])
    assert sd_now[0] < 0.1 * sd_now[2]
    assert (sd_now > sd).sum() >= N - 1  # nothing is known better than it was


def test_who_moves_may_move_more_and_never_less_than_nothing() -> None:
    still = spread(information(np.full((N, N), 0.0) + 1e-8 * np.eye(N), np.zeros(N)))
    step = np.zeros(N)
    step[:3] = 0.02
    moving = spread(information(1e-8 * np.eye(N), step))
    assert (moving[:3] > 3.0 * still[:3]).all()
    np.testing.assert_allclose(moving[3:], still[3:], rtol=1e-6)
    assert (moving <= USUAL).all()


def test_a_longer_pause_leaves_more_open() -> None:
    short = spread(information(1e-8 * np.eye(N), np.zeros(N)))
    long = spread(information(1e-8 * np.eye(N), np.zeros(N), frames=9.0))
    np.testing.assert_allclose(long, 3.0 * short, rtol=0.02)


def test_an_arm_that_no_picture_confirms_is_held_alike_however_it_moved() -> None:
    step = np.full(N, 0.15)
    seen, hidden = (
        spread(information(1e-8 * np.eye(N), step, left=confirmed)) for confirmed in (1.0, 0.0)
    )
    assert (hidden[ARM["left"]] < seen[ARM["left"]]).all()
    np.testing.assert_allclose(hidden[ARM["left"]], _HIDDEN_SD_RAD, rtol=0.2)
    np.testing.assert_allclose(hidden[ARM["right"]], seen[ARM["right"]])


def test_a_fit_says_what_its_cameras_cannot() -> None:
    """One camera hardly knows the depth, two do."""
    truth = standing()
    depth_sd = []
    for cameras in (1, 2):
        by = fitter(cameras)
        fit = by.fit(truth, views_of(by, truth), 1 / 30, 2)
        ray = truth.root_m + by.drawings[0].camera.R.T @ by.drawings[0].camera.t_m
        ray /= np.linalg.norm(ray)
        depth_sd.append(float(np.sqrt(ray @ fit.covariance[:3, :3] @ ray)))
    assert depth_sd[0] > 2.0 * depth_sd[1]


# --- arms of which nothing is seen -----------------------------------------------------------


def test_the_mean_arm_hangs_bent_beside_the_body() -> None:
    known = load_arm_motion()
    by, state = fitter(1), standing()
    local = state.local_xyzw.copy()
    for side, arm in (("left", known), ("right", known.mirror_arm())):
        local[[INDEX[side + bone] for bone in ("Shoulder", "UpperArm", "LowerArm")]] = arm.mean_xyzw
    joints, _ = by.joints(replace(state, local_xyzw=local))
    for side in SIDES:
        shoulder, elbow, hand = (joints[INDEX[side + b]] for b in ("UpperArm", "LowerArm", "Hand"))
        assert elbow[1] < shoulder[1] - 0.15
        assert hand[1] < shoulder[1]
        assert 0.2 < np.linalg.norm(hand - shoulder) < 0.55


def test_the_right_arm_is_the_left_one_mirrored() -> None:
    known = load_arm_motion()
    twice = known.mirror_arm().mirror_arm()
    np.testing.assert_array_equal(twice.mean_xyzw, known.mean_xyzw)
    np.testing.assert_array_equal(twice.covariance_rad2, known.covariance_rad2)
    upper = rotations.log(known.mean_xyzw[1])
    np.testing.assert_allclose(
        rotations.log(known.mirror_arm().mean_xyzw[1]), upper * [1.0, -1.0, -1.0], atol=1e-12
    )
    assert np.linalg.eigvalsh(known.mirror_arm().covariance_rad2).min() > 0.0
