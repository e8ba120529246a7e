"""Poses of an arm whose hand is where something is seen: it gets there, bent as elbows bend."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.fit_params import FitParams
from mocapd.fit.limbs.arm_samples import Arm, arm_of
from mocapd.fit.limbs.hand_target_poses import hand_poses, hand_target_poses
from mocapd.fit.limbs.limb_scores import score_arms_and_hands
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.types import Floats
from tests.fit.synthetic import FACTOR, LABELS, MODEL, standing
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

BESIDE = tuple(
    looking_at(name, np.array([x, 1.2, 2.6]), np.array([x, 1.1, 0.0]))
    for name, x in (("left", -0.06), ("right", 0.06))
)


def body() -> Fitter:
    return Fitter(MODEL, LABELS, BESIDE, [FACTOR] * 2, FitParams())


def hands(by: Fitter, arm: Arm, poses: Floats) -> Floats:
    """Where the hand (N,3) of each pose of an arm is."""
    state, out = standing(), []
    for pose in poses:
        local = state.local_xyzw.copy()
        local[arm.chain[:3]] = pose
        out.append(by.joints(replace(state, local_xyzw=local))[0][arm.chain[3]])
    return np.array(out)


def poses(by: Fitter, arm: Arm, hands_m: Floats) -> Floats:
    state = standing()
    joints, globals_ = by.joints(state)
    return hand_poses(hands_m, joints, globals_, arm, state.local_xyzw[arm.chain[:3]])


@pytest.mark.parametrize("side", SIDES)
def test_hands_reach_what_is_in_reach(side: str) -> None:
    by, arm = body(), arm_of(MODEL, LABELS, side)
    shoulder = by.joints(standing())[0][arm.chain[1]]
    wanted = shoulder + np.array([[0.1, 0.1, 0.35], [0.2, -0.3, 0.2], [-0.2, 0.0, 0.3]])
    found = poses(by, arm, wanted)
    assert len(found) == 4 * len(wanted)
    np.testing.assert_allclose(hands(by, arm, found), np.tile(wanted, (4, 1)), atol=1e-6)


@pytest.mark.parametrize("side", SIDES)
def test_a_hand_out_of_reach_is_pointed_at(side: str) -> None:
    by, arm = body(), arm_of(MODEL, LABELS, side)
    shoulder = by.joints(standing())[0][arm.chain[1]]
    (hand, *_) = hands(by, arm, poses(by, arm, shoulder + np.array([[0.0, 0.0, 2.0]])))
    way = hand - shoulder
    np.testing.assert_allclose(way / np.linalg.norm(way), [0.0, 0.0, 1.0], atol=1e-6)


@pytest.mark.parametrize("side", SIDES)
def test_elbows_bend_about_their_hinge_forwards(side: str) -> None:
    by, arm = body(), arm_of(MODEL, LABELS, side)
    shoulder = by.joints(standing())[0][arm.chain[1]]
    forearms = poses(by, arm, shoulder + np.array([[0.1, -0.1, 0.3]]))[:, 2]
    outwards = 1.0 if side == "left" else -1.0
    np.testing.assert_allclose(forearms[:, [0, 2]], 0.0, atol=1e-9)
    assert (forearms[:, 1] * outwards < 0.0).all()


@pytest.mark.parametrize("side", SIDES)
def test_an_arm_stretched_out_to_the_cameras_is_found_by_its_depth(side: str) -> None:
    """Before a trunk of its own colour no outline tells; thought to hang, it is tried and scores best where it is."""
    by, arm = body(), arm_of(MODEL, LABELS, side)
    truth, thought = standing("forward_low", "forward_low"), standing("hanging", "hanging")
    truth = replace(truth, local_xyzw=truth.local_xyzw.copy())
    drawing = by.drawings[0]
    roi = drawing.region(truth, 0.0, 20)
    assert roi is not None
    one_colour = np.asarray(drawing.render(truth, 0.0, roi) > 0, np.uint8)
    depth_m = np.where(one_colour > 0, drawing.last_depth_m(roi), np.float32(np.nan))
    flat = np.full(one_colour.shape, 255, np.uint8)
    view = View(0, roi, one_colour, flat, 0.0, depth_m=depth_m.astype(np.float32))
    tried = hand_target_poses(by, thought, arm, [view], 24, 0)
    assert len(tried)
    tries = np.concatenate([thought.local_xyzw[arm.chain[:3]][None], tried])
    best = int(np.argmax(score_arms_and_hands(by, thought, arm, [view], tries, 0.0, 0.5)[0]))
    hand = by.joints(truth)[0][INDEX[f"{side}Hand"]]
    assert best > 0
    off_m = np.linalg.norm(hands(by, arm, tries[best : best + 1])[0] - hand)
    was_m = np.linalg.norm(hands(by, arm, tries[:1])[0] - hand)
    assert off_m < 0.6 * was_m


def test_nothing_is_tried_where_no_camera_sees_depths() -> None:
    by = body()
    flat = np.zeros((40, 40), np.uint8)
    view = View(0, (100, 60, 140, 100), flat, flat, 0.0)
    assert len(hand_target_poses(by, standing(), arm_of(MODEL, LABELS, "left"), [view], 24, 0)) == 0
