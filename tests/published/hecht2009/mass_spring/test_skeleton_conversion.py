"""Between points and skeleton: nothing that points determine is lost."""

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX, N_JOINTS, global_from_local, joint_positions
from mocapd.geometry import rotations
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    JOINT_POINTS,
    JOINTS_OF_POINTS,
    N_POINTS,
    WRIST,
)
from mocapd.published.hecht2009.mass_spring.mass_spring_body import build_body
from mocapd.published.hecht2009.mass_spring.simulation import (
    MassSpringState,
    project_onto_constraints,
    relaxed_state,
    resting,
    simulate,
)
from mocapd.published.hecht2009.mass_spring.skeleton_conversion import (
    points_from_skeleton,
    skeleton_from_points,
)
from mocapd.published.hecht2009.mass_spring.springs import COMPLIANCE, spring_lengths
from mocapd.types import Floats, Pose

BODY = build_body(mean_shape(1.75))
seeds = st.integers(0, 2**32 - 1)
quick = settings(max_examples=40, deadline=None)


def posed(
    turns: Mapping[str, Floats | list[float]], root: Floats = BODY.skeleton.rest_m[0]
) -> Pose:
    """A pose by local rotation vectors of some bones."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for name, turn in turns.items():
        local[INDEX[name]] = rotations.exp(np.asarray(turn, dtype=float))
    return Pose(np.asarray(root, dtype=float), global_from_local(BODY.skeleton, local))


def random_pose(seed: int) -> Pose:
    """Somewhere, turned anywhere about Y, limbs bent as they can be."""
    rng = np.random.default_rng(seed)
    turns = {"hips": np.array([0.1, rng.uniform(-np.pi, np.pi), -0.1])}
    bend = rng.uniform(-0.15, 0.2, 3)
    turns |= dict.fromkeys(("spine", "chest", "upperChest"), bend)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        turns[side + "UpperArm"] = rng.uniform(-0.9, 0.9, 3) * [0.0, 1.0, 1.0]
        turns[side + "LowerArm"] = np.array([0.0, -sign * rng.uniform(0.0, 2.0), 0.0])
        turns[side + "UpperLeg"] = rng.uniform([-1.2, 0.0, -0.2], [0.3, 0.0, 0.2])
        turns[side + "LowerLeg"] = np.array([rng.uniform(0.0, 2.0), 0.0, 0.0])
    return posed(turns, rng.normal(size=3))


@quick
@given(seeds)
def test_joints_survive_the_way_through_the_points(seed: int) -> None:
    pose = random_pose(seed)
    points = points_from_skeleton(BODY, pose)
    back = skeleton_from_points(BODY, points)
    assert rotations.canonical(back.quats_xyzw) == pytest.approx(back.quats_xyzw)
    joints = joint_positions(BODY.skeleton, pose)
    again = joint_positions(BODY.skeleton, back)
    error = np.linalg.norm(again - joints, axis=1)
    assert error[JOINTS_OF_POINTS].max() < 0.03
    assert error[INDEX["head"]] < 0.035
    # what has been through once comes through again
    twice = skeleton_from_points(BODY, points_from_skeleton(BODY, back))
    assert np.linalg.norm(joint_positions(BODY.skeleton, twice) - again, axis=1).max() < 0.03


def test_the_t_pose_is_the_t_pose() -> None:
    result = skeleton_from_points(BODY, BODY.rest_m)
    assert np.abs(result.root_m - BODY.skeleton.rest_m[0]).max() < 1e-9
    assert np.degrees(rotations.angle_rad(result.quats_xyzw, rotations.IDENTITY_XYZW)).max() < 0.01  # fmt: skip


@quick
@given(seeds)
def test_limbs_point_where_their_points_are(seed: int) -> None:
    # the three bones of the spine bend in an arc, the points' trunk at the waist: centimetres apart where it is bent far
    start = relaxed_state(BODY, np.array([0.0, 1.63, 0.0]))
    velocities = 1.5 * np.random.default_rng(seed).normal(size=(N_POINTS, 3))
    state = MassSpringState(start.points_m, velocities)
    for _ in range(6):
        state = simulate(BODY, state, 1.0 / 30.0)
    pose = skeleton_from_points(BODY, state.points_m)
    joints = joint_positions(BODY.skeleton, pose)
    apart = np.linalg.norm(joints[JOINTS_OF_POINTS] - state.points_m[JOINT_POINTS], axis=1)
    assert apart.max() < 0.08
    assert np.median(apart) < 0.03


@pytest.mark.parametrize("twist", [-1.2, -0.5, 0.0, 0.7, 1.2])
@pytest.mark.parametrize(("side", "sign"), [("left", 1.0), ("right", -1.0)])
def test_a_bent_elbow_tells_the_twist_of_the_arm(side: str, sign: float, twist: float) -> None:
    pose = posed({side + "UpperArm": [twist, 0, 0], side + "LowerArm": [0, -sign * 1.5, 0]})
    result = skeleton_from_points(BODY, points_from_skeleton(BODY, pose))
    j = INDEX[side + "UpperArm"]
    off = rotations.angle_rad(result.quats_xyzw[j], pose.quats_xyzw[j])
    assert float(off) < 0.15 * abs(twist) + 0.02


@pytest.mark.parametrize("twist", [-0.6, 0.4])
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_bent_knee_tells_the_twist_of_the_thigh(side: str, twist: float) -> None:
    pose = posed({side + "UpperLeg": [0, twist, 0], side + "LowerLeg": [1.4, 0, 0]})
    result = skeleton_from_points(BODY, points_from_skeleton(BODY, pose))
    j = INDEX[side + "UpperLeg"]
    off = float(rotations.angle_rad(result.quats_xyzw[j], pose.quats_xyzw[j]))
    assert off < 0.45 * abs(twist)  # an open hip is turned back to what is usual


def test_a_straight_arm_has_the_smallest_twist() -> None:
    straight = posed({"leftUpperArm": [0.9, 0, 0]})
    result = skeleton_from_points(BODY, points_from_skeleton(BODY, straight))
    arm = result.quats_xyzw[INDEX["leftUpperArm"]]
    assert np.degrees(rotations.angle_rad(arm, rotations.IDENTITY_XYZW)) < 1


def test_the_bend_of_a_hardly_bent_arm_turns_nothing_suddenly() -> None:
    last = None
    for bend in np.linspace(-0.05, 0.6, 60):
        # bent upwards: a quarter turn of the upper arm when it counts
        pose = posed({"leftLowerArm": [0, 0, bend]})
        q = skeleton_from_points(BODY, points_from_skeleton(BODY, pose)).quats_xyzw[
            INDEX["leftUpperArm"]
        ]
        if last is not None:
            assert np.degrees(rotations.angle_rad(q, last)) < 12.0
        last = q


@pytest.mark.parametrize("seed", range(5))
def test_noise_and_nonsense_give_rotations(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for points in (rng.normal(size=(N_POINTS, 3)), np.zeros((N_POINTS, 3)), -BODY.rest_m):
        pose = skeleton_from_points(BODY, points)
        assert np.isfinite(pose.quats_xyzw).all()
        assert np.linalg.norm(pose.quats_xyzw, axis=1) == pytest.approx(np.ones(N_JOINTS))


@quick
@given(seeds)
def test_another_trackers_body_starts_this_one(seed: int) -> None:
    points = points_from_skeleton(BODY, random_pose(seed))
    after = project_onto_constraints(BODY, resting(points)).points_m
    # the pose is nearly valid: springs and limits move nothing far but the hands at the trunk
    assert np.median(np.linalg.norm(after - points, axis=1)) < 0.05
    assert np.isfinite(after).all()
    lengths = spring_lengths(after)
    bones = COMPLIANCE == 0.0
    assert np.abs(lengths - BODY.constraints.lengths)[bones].max() < 0.02


def test_an_asymmetric_pose_has_its_points_on_the_right_sides() -> None:
    raised = posed({"leftUpperArm": [0, 0, 1.2], "rightUpperLeg": [-1.2, 0, 0]})
    p = points_from_skeleton(BODY, raised)
    assert p[ELBOW[0], 1] > p[ELBOW[1], 1] + 0.2
    assert p[WRIST[0], 0] > 0.0 > p[WRIST[1], 0]
    assert p[ANKLE[1], 2] > p[ANKLE[0], 2] + 0.3
