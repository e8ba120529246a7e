"""One body of two: whose is what."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions, standard_skeleton
from mocapd.trackers.supervisor.joining import apart_m, joined
from mocapd.types import BodyState, Pose, Tracking
from tests.body.random_poses import pose_of, random_local, random_root

SKELETON = standard_skeleton(1.75)
UPPER = ("hips", "spine", "chest", "upperChest", "neck", "leftHand", "rightLowerArm")
LOWER = ("head", "leftUpperLeg", "leftFoot", "rightToes")


def body(
    name: str, seed: int, camera: str, sure: float, live: Tracking = Tracking.LIVE
) -> BodyState:
    pose = pose_of(SKELETON, random_root(seed), random_local(seed, 0.3))
    joints_m = joint_positions(SKELETON, pose)
    unsure_m = np.full(N_JOINTS, 0.1 * (1.0 - sure))
    confidence = np.full(N_JOINTS, sure)
    return BodyState(5, live, name, pose, joints_m, confidence, (camera, "both"), 0, unsure_m)


def test_each_joint_is_as_sure_as_who_sees_it_says() -> None:
    upper, lower = body("one", 1, "left", 0.9, Tracking.COASTING), body("two", 2, "right", 0.4)
    both = joined(upper, lower, SKELETON)
    assert (both.tracker, both.tracking) == ("one+two", Tracking.COASTING)
    assert both.cameras == ("left", "both", "right")
    for names, of in ((UPPER, upper), (LOWER, lower)):
        rows = [INDEX[name] for name in names]
        assert np.array_equal(both.confidence[rows], of.confidence[rows])
        assert np.array_equal(both.uncertainty_m[rows], of.uncertainty_m[rows])


def test_bones_point_as_who_sees_them_says_and_hang_from_the_upper_body() -> None:
    upper, lower = body("one", 1, "left", 0.9), body("two", 2, "right", 0.4)
    both = joined(upper, lower, SKELETON)
    assert both.joints_m is not None
    assert upper.joints_m is not None
    assert lower.joints_m is not None
    rows = [INDEX[name] for name in UPPER]
    assert np.allclose(both.joints_m[rows], upper.joints_m[rows])
    for first, last in (
        ("neck", "head"),
        ("leftUpperLeg", "leftFoot"),
        ("rightUpperLeg", "rightToes"),
    ):
        a, b = INDEX[first], INDEX[last]
        assert np.allclose(
            both.joints_m[b] - both.joints_m[a], lower.joints_m[b] - lower.joints_m[a]
        )


def test_how_far_bodies_are_apart_is_told_by_their_trunks() -> None:
    upper = body("one", 1, "left", 0.9)
    assert upper.pose is not None
    moved = Pose(upper.pose.root_m + (0.0, 0.0, 0.2), upper.pose.quats_xyzw)
    lower = replace(upper, tracker="two", pose=moved, joints_m=joint_positions(SKELETON, moved))
    assert apart_m(upper, lower) == pytest.approx(0.2)
    assert apart_m(upper, replace(lower, pose=None, joints_m=None)) == np.inf
