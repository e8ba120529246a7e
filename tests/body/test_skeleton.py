"""Forward kinematics and the two ways of writing a pose."""

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import (
    INDEX,
    N_JOINTS,
    PARENTS,
    global_from_local,
    joint_positions,
    local_from_global,
    rest_pose,
    standard_skeleton,
)
from mocapd.geometry import rotations
from mocapd.types import Floats, Pose
from tests.body.random_poses import pose_of, random_local, random_root

SKELETON = standard_skeleton(1.7)
SEEDS = range(5)


def naive_chain(root_m: Floats, local_xyzw: Floats) -> tuple[Floats, Floats]:
    """Joints (J,3) and global rotations (J,4), bone by bone from the root."""
    joints, turned = np.zeros((N_JOINTS, 3)), np.zeros((N_JOINTS, 4))
    for j in range(N_JOINTS):
        p = PARENTS[j]
        if p < 0:
            joints[j], turned[j] = root_m, local_xyzw[j]
            continue
        turned[j] = rotations.multiply(turned[p], local_xyzw[j])
        joints[j] = joints[p] + rotations.to_matrix(turned[p]) @ (
            SKELETON.rest_m[j] - SKELETON.rest_m[p]
        )
    return joints, rotations.canonical(turned)


def test_parents_come_before_their_children() -> None:
    assert PARENTS[0] == -1
    assert (PARENTS[1:] >= 0).all()
    assert (PARENTS[1:] < np.arange(1, N_JOINTS)).all()


def test_the_t_pose_stands_on_the_floor_facing_forwards() -> None:
    rest = dict(zip(NAMES, SKELETON.rest_m, strict=True))
    assert rest["leftHand"][0] > rest["leftLowerArm"][0] > rest["leftUpperArm"][0] > 0
    assert rest["head"][1] > rest["neck"][1] > rest["hips"][1] > rest["leftFoot"][1] > 0
    assert rest["leftToes"][2] > rest["leftFoot"][2]
    assert 0.0 <= SKELETON.rest_m[:, 1].min() < 0.1
    assert SKELETON.rest_m[:, 1].max() < 1.7


def test_the_rest_pose_has_the_rest_joints() -> None:
    np.testing.assert_allclose(
        joint_positions(SKELETON, rest_pose(SKELETON)), SKELETON.rest_m, atol=1e-12
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_forward_kinematics_equals_the_chain(seed: int) -> None:
    root, local = random_root(seed), random_local(seed)
    joints, turned = naive_chain(root, local)
    pose = pose_of(SKELETON, root, local)
    np.testing.assert_allclose(pose.quats_xyzw, turned, atol=1e-12)
    np.testing.assert_allclose(joint_positions(SKELETON, pose), joints, atol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_bones_keep_their_lengths(seed: int) -> None:
    joints = joint_positions(SKELETON, pose_of(SKELETON, random_root(seed), random_local(seed)))
    for of in (joints, SKELETON.rest_m):
        assert of.shape == (N_JOINTS, 3)
    posed = np.linalg.norm(joints[1:] - joints[PARENTS[1:]], axis=1)
    rest = np.linalg.norm(SKELETON.rest_m[1:] - SKELETON.rest_m[PARENTS[1:]], axis=1)
    np.testing.assert_allclose(posed, rest, atol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_turning_the_whole_body_turns_its_joints(seed: int) -> None:
    pose = pose_of(SKELETON, random_root(seed), random_local(seed))
    turn = rotations.exp(np.array([0.4, -0.9, 0.2]))
    turned = Pose(
        rotations.rotate(turn, pose.root_m),
        rotations.canonical(rotations.multiply(turn, pose.quats_xyzw)),
    )
    np.testing.assert_allclose(
        joint_positions(SKELETON, turned),
        rotations.rotate(turn, joint_positions(SKELETON, pose)),
        atol=1e-12,
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_local_and_global_rotations_are_inverse(seed: int) -> None:
    local = random_local(seed)
    there = global_from_local(SKELETON, local)
    np.testing.assert_allclose(local_from_global(SKELETON, there), local, atol=1e-12)
    assert (there[:, 3] >= 0).all()


def test_a_bent_elbow_moves_the_hand_only() -> None:
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[INDEX["leftLowerArm"]] = rotations.exp(np.array([0.0, -np.pi / 2, 0.0]))
    rest = SKELETON.rest_m
    joints = joint_positions(SKELETON, pose_of(SKELETON, rest[0], local))
    moved = np.linalg.norm(joints - rest, axis=1) > 1e-9
    assert set(np.flatnonzero(moved)) == {INDEX["leftHand"]}
    elbow, wrist = joints[INDEX["leftLowerArm"]], joints[INDEX["leftHand"]]
    # about -y: the forearm, to the left in the T-pose, now points forwards
    assert wrist[2] - elbow[2] == pytest.approx(np.linalg.norm(wrist - elbow), rel=0.02)
