"""Keypoints of several cameras: left and right are told by where rays meet, and who is contradicted counts less."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, OTHER_SIDE
from mocapd.fit.terms.joint_term import JointRays
from mocapd.tracking.cues.keypoints.keypoint_consensus import agreed_keypoints
from mocapd.vision.heatmaps.joint_network import JOINTS
from tests.fit.term_system import posed
from tests.fit.test_joint_term import seen_at
from tests.fit.test_pose_terms import ROOT, bent
from tests.geometry.rigs import ring

pytestmark = pytest.mark.kernels

ALL = np.array([INDEX[name] for name in JOINTS])
TRUE_M = posed(ROOT, bent()).joints
PREDICTED_M = TRUE_M + (0.03, -0.02, 0.04)
HAND = INDEX["leftHand"]
ARM = [INDEX[side + joint] for side in ("left", "right") for joint in ("LowerArm", "Hand")]
LEG = [INDEX[side + joint] for side in ("left", "right") for joint in ("LowerLeg", "Foot", "Toes")]


def seen_by(count: int) -> list[JointRays]:
    return seen_at(TRUE_M, 0.004, ALL, ring(count))


def taken_for_each_other(rays: JointRays, limb: list[int]) -> JointRays:
    """A camera that takes the left limb for the right one."""
    is_of_limb = np.isin(rays.joints, limb)
    return replace(rays, joints=np.where(is_of_limb, OTHER_SIDE[rays.joints], rays.joints))


def seen_beside(rays: JointRays, joint: int, off: float) -> JointRays:
    """A camera that sees a joint so far beside, at a distance of 1."""
    return replace(rays, xy=rays.xy + np.where(rays.joints == joint, off, 0.0)[:, None])


def shares(agreed: list[JointRays], rays: list[JointRays], joint: int) -> list[float]:
    """What each camera's keypoint of a joint is worth, relative to what it said."""
    return [
        float((one.information / was.information)[one.joints == joint].max())
        for one, was in zip(agreed, rays, strict=True)
    ]


@pytest.mark.parametrize("limb", [ARM, LEG])
@pytest.mark.parametrize("count", [3, 4])
def test_a_camera_that_takes_left_for_right_is_corrected_by_the_others(
    limb: list[int], count: int
) -> None:
    true = seen_by(count)
    for wrong in range(count):
        rays = [taken_for_each_other(r, limb) if i == wrong else r for i, r in enumerate(true)]
        for one, was in zip(agreed_keypoints(rays, PREDICTED_M), true, strict=True):
            assert (one.joints == was.joints).all()


def test_two_of_four_are_corrected_by_where_the_body_was() -> None:
    true = seen_by(4)
    rays = [taken_for_each_other(r, LEG) if i < 2 else r for i, r in enumerate(true)]
    for one, was in zip(agreed_keypoints(rays, PREDICTED_M), true, strict=True):
        assert (one.joints == was.joints).all()


def test_keypoints_that_meet_are_as_they_were() -> None:
    true = seen_by(4)
    agreed = agreed_keypoints(true, PREDICTED_M)
    for one, was in zip(agreed, true, strict=True):
        assert (one.joints == was.joints).all()
    assert min(shares(agreed, true, HAND)) > 0.9


def test_a_keypoint_that_the_others_contradict_counts_less_and_no_label_changes() -> None:
    true = seen_by(4)
    rays = [seen_beside(true[0], HAND, 0.2), *true[1:]]
    agreed = agreed_keypoints(rays, PREDICTED_M)
    for one, was in zip(agreed, rays, strict=True):
        assert (one.joints == was.joints).all()
    worth = shares(agreed, rays, HAND)
    assert worth[0] < 0.05
    assert min(worth[1:]) > 0.8
    assert agreed[0].depth_information[rays[0].joints == HAND] < 0.05 * rays[0].depth_information[0]


def test_a_joint_that_a_camera_does_not_see_is_told_by_the_others() -> None:
    true = seen_by(4)
    rays = [true[0].of(set(ALL) - {HAND}), taken_for_each_other(true[1], ARM), *true[2:]]
    agreed = agreed_keypoints(rays, PREDICTED_M)
    assert (agreed[0].joints == rays[0].joints).all()
    assert (agreed[1].joints == true[1].joints).all()


def test_of_two_cameras_neither_is_corrected() -> None:
    true = seen_by(2)
    rays = [taken_for_each_other(true[0], ARM), true[1]]
    assert agreed_keypoints(rays, PREDICTED_M) == rays
