"""A limb's bones are turned so that its joints come to lie where they are wanted, and it bends as limbs do."""

import numpy as np
import pytest

from mocapd.body.skeleton import (
    INDEX,
    N_JOINTS,
    global_from_local,
    joint_positions,
    standard_skeleton,
)
from mocapd.fit.limbs.two_bone_ik import LIMBS, two_bone_pose
from mocapd.geometry import rotations
from mocapd.types import Floats, Pose

SKELETON = standard_skeleton(1.75)
REST_M = SKELETON.rest_m


def posed(local: Floats) -> tuple[Floats, Floats]:
    quats = global_from_local(SKELETON, local)
    return joint_positions(SKELETON, Pose(REST_M[0].copy(), quats)), quats


def turned_somehow(rng: np.random.Generator) -> Floats:
    return rotations.exp(rng.normal(0.0, 0.4, (N_JOINTS, 3)))


@pytest.mark.parametrize("name", list(LIMBS))
def test_a_limb_in_any_pose_reaches_where_another_one_was(name: str) -> None:
    limb, rng = LIMBS[name], np.random.default_rng(3)
    for _ in range(20):
        wanted = turned_somehow(rng)
        # a hinge that bends by 90 degrees as people's do
        wanted[limb.lower] = rotations.exp(np.array(limb.hinge) * 0.5 * np.pi)
        places_m, quats = posed(wanted)
        now = wanted.copy()
        now[[limb.upper, limb.lower]] = turned_somehow(rng)[[limb.upper, limb.lower]]
        joints_m, globals_xyzw = posed(now)
        bent = two_bone_pose(limb, REST_M, joints_m, globals_xyzw, places_m)
        assert bent is not None
        now[[limb.upper, limb.lower]] = bent
        there_m, there = posed(now)
        np.testing.assert_allclose(
            there_m[[limb.lower, limb.end]], places_m[[limb.lower, limb.end]], atol=1e-6
        )
        # with the twist that the bend tells, too
        assert rotations.angle_rad(there[limb.upper], quats[limb.upper]) < 0.15


def test_a_straight_limb_keeps_its_twist() -> None:
    limb = LIMBS["left_leg"]
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    joints_m, globals_xyzw = posed(local)
    bent = two_bone_pose(limb, REST_M, joints_m, globals_xyzw, joints_m)
    assert bent is not None
    assert rotations.angle_rad(bent, local[[limb.upper, limb.lower]]).max() < 1e-6


def test_what_was_not_seen_bends_nothing() -> None:
    limb = LIMBS["right_arm"]
    joints_m, globals_xyzw = posed(np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)))
    places_m = joints_m.copy()
    places_m[INDEX["rightHand"]] = np.nan
    assert two_bone_pose(limb, REST_M, joints_m, globals_xyzw, places_m) is None
