"""Confidence of joints: what is seen is believed, what is hidden is not."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.fit.joint_uncertainty import joint_uncertainty_m, pose_covariance
from mocapd.fit.view import View
from mocapd.geometry.camera_model import project
from mocapd.tracking.joint_confidence import shirt_confidence
from mocapd.types import Floats
from tests.fit.synthetic import fitter, standing, views_of

pytestmark = pytest.mark.kernels

RIGHT = [INDEX["right" + bone] for bone in ("LowerArm", "Hand")]
LEFT = [INDEX["left" + bone] for bone in ("LowerArm", "Hand")]
TORSO = [INDEX[name] for name in ("hips", "spine", "chest", "upperChest", "neck")]


def fit_of(n_cameras: int) -> Fit:
    """A fit to what the cameras see of a person in the open."""
    by, state = fitter(n_cameras), standing("t_pose", "t_pose")
    return by.fit(state, views_of(by, state), 1 / 30, 5)


def behind_a_board(n_cameras: int) -> Fit:
    """The same while a board hides the right arm from the shoulder on: all pixels beyond it."""
    by, state = fitter(n_cameras), standing("t_pose", "t_pose")
    arm = by.joints(state)[0][[INDEX["rightUpperArm"], INDEX["rightHand"]]]
    views: list[View] = []
    for view in views_of(by, state):
        drawing = by.drawings[view.index]
        shoulder, wrist = project(drawing.camera, arm)[:, 0] / drawing.image_scale
        x = np.arange(view.roi[0], view.roi[2])
        beyond = x < shoulder if wrist < shoulder else x > shoulder
        ids, pixel_weight = view.ids.copy(), view.pixel_weight.copy()
        ids[:, beyond], pixel_weight[:, beyond] = 0, 60
        views.append(replace(view, ids=ids, pixel_weight=pixel_weight))
    return by.fit(state, views, 1 / 30, 5)


def confidence(fit: Fit, n_cameras: int, away_s: float = 0.0) -> Floats:
    by = fitter(n_cameras)
    placed = pose_covariance(by.model, fit.H)
    uncertainty_m = joint_uncertainty_m(by.model, *by.joints(fit.state), placed)
    out = shirt_confidence(fit, n_cameras, uncertainty_m, away_s)
    assert out.shape == (N_JOINTS,)
    assert ((out >= 0.0) & (out <= 1.0)).all()
    return out


def test_what_two_cameras_see_well_is_believed() -> None:
    seen = confidence(fit_of(2), 2)
    assert seen[TORSO].min() > 0.8
    assert seen[LEFT + RIGHT].min() > 0.7


def test_a_hidden_arm_is_not_believed_and_the_rest_is() -> None:
    seen, hidden = confidence(fit_of(2), 2), confidence(behind_a_board(2), 2)
    assert hidden[RIGHT].max() < 0.15
    assert hidden[LEFT].min() > 0.7
    assert hidden[TORSO].min() > 0.7
    assert (hidden[RIGHT] < 0.2 * seen[RIGHT]).all()


def test_one_camera_is_believed_less_than_two() -> None:
    one, two = confidence(fit_of(1), 1), confidence(fit_of(2), 2)
    told = [*TORSO, *LEFT, *RIGHT]
    assert (one[told] < two[told]).all()
    assert one[told].mean() < 0.9 * two[told].mean()


def test_the_head_follows_the_neck_at_a_distance_and_of_legs_nothing_is_known() -> None:
    seen = confidence(fit_of(2), 2)
    assert 0.0 < seen[INDEX["head"]] < seen[INDEX["neck"]]
    legs = [f"{side}{bone}" for side in SIDES for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes")]
    assert not seen[[INDEX[name] for name in legs]].any()


def test_confidence_fades_while_there_is_no_evidence() -> None:
    fit = fit_of(2)
    faded = [confidence(fit, 2, away_s)[TORSO].max() for away_s in (0.0, 0.1, 0.3, 1.0)]
    assert faded == sorted(faded, reverse=True)
    assert faded[-1] < 0.01
    assert faded[1] == pytest.approx(np.exp(-0.1 / 0.15) * faded[0])


def test_nobody_is_nobody() -> None:
    assert not shirt_confidence(None, 2, np.full(N_JOINTS, np.inf), 0.0).any()
