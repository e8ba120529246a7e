"""Joints that were seen: rows that are derivatives, costs told by joint, and bodies that go where they were seen."""

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.motion_state import apply_step
from mocapd.fit.terms.joint_term import JointRays, JointTerm, JointTermParams
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import to_camera
from mocapd.types import Camera, Floats
from tests.fit.term_system import BODY, posed, system
from tests.fit.test_pose_terms import CAMERAS, ROOT, bent, relaxed, settled
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

SEEN = np.array(
    [INDEX[n] for n in ("hips", "leftHand", "rightLowerArm", "leftFoot", "rightUpperArm")]
)


def seen_at(
    joints_m: Floats,
    off: float = 0.0,
    which: np.ndarray = SEEN,
    cameras: tuple[Camera, ...] = CAMERAS,
) -> list[JointRays]:
    """What the cameras see of some joints, each a little beside."""
    out = []
    for k, camera in enumerate(cameras):
        rng = np.random.default_rng(k)
        there = to_camera(camera, joints_m)
        xy = there[which, :2] / there[which, 2:] + rng.normal(0.0, off, (len(which), 2))
        information = np.tile([400.0, 120.0, 300.0], (len(which), 1))
        farther_m = there[which, 2] - there[0, 2] + rng.normal(0.0, off, len(which))
        out.append(JointRays(camera, which, xy, information, farther_m, np.full(len(which), 90.0)))
    return out


CROSSING = tuple(
    looking_at(name, np.array([x_m, 1.5, 2.0]), np.array([0.0, 0.9, 0.0]))
    for name, x_m in (("left", -2.0), ("right", 2.0))
)
FEET = np.array([INDEX[side + bone] for side in ("left", "right") for bone in ("Foot", "Toes")])


@pytest.mark.parametrize(("which", "off"), [(SEEN, 0.002), (FEET, 0.0005)])
def test_rows_are_the_derivatives_of_the_cost(which: np.ndarray, off: float) -> None:
    local = bent()
    seen = seen_at(posed(ROOT, local).joints, off, which, CROSSING if which is FEET else CAMERAS)
    term = JointTerm(BODY, seen, JointTermParams(robust=100.0))
    cost, H, b = system(term, ROOT, local)
    assert cost > 0.0
    assert np.allclose(H, H.T)
    for k in range(BODY.n_pose):
        ends = []
        for sign in (1.0, -1.0):
            step = np.zeros(BODY.n_pose)
            step[k] = sign * 1e-6
            ends.append(system(term, *apply_step(BODY, ROOT, local, step))[0])
        slope = (ends[0] - ends[1]) / 2e-6
        assert slope == pytest.approx(-2.0 * b[k], rel=0.03, abs=5e-3 * np.abs(b).max())


def test_what_each_joint_costs_adds_up_to_the_cost() -> None:
    local = bent()
    joints_m = posed(ROOT, local).joints
    lower = np.setdiff1d(SEEN, [0])  # the hips' own depth is nothing beside themselves
    term = JointTerm(BODY, seen_at(joints_m, 0.05, lower))
    costs = term.costs(joints_m)
    assert costs.sum() == pytest.approx(system(term, ROOT, local)[0])
    assert np.flatnonzero(costs).tolist() == sorted(lower.tolist())


def test_depths_alone_say_nothing_across_the_view_and_nothing_of_other_joints() -> None:
    local, hand = bent(), INDEX["leftHand"]
    joints_m = posed(ROOT, local).joints
    term = JointTerm(BODY, seen_at(joints_m, 0.05)[:1]).depths(BODY, [hand], 2.0)
    (rays,) = term.rays
    assert rays.joints.tolist() == [hand]
    deeper_m = np.zeros_like(joints_m)
    deeper_m[hand] = 0.1 * rays.camera.R[2]
    across_m = np.zeros_like(joints_m)
    across_m[hand] = 0.1 * rays.camera.R[0]
    cost = term.costs(joints_m)
    assert np.flatnonzero(cost).tolist() == [hand]
    assert term.costs(joints_m + across_m)[hand] == pytest.approx(cost[hand])
    assert term.costs(joints_m + deeper_m)[hand] != pytest.approx(cost[hand], rel=0.1)
    assert system(term, ROOT, local)[0] == pytest.approx(cost[hand])


def test_a_body_goes_to_where_its_joints_were_seen() -> None:
    local = relaxed()
    raised = local.copy()
    raised[INDEX["leftUpperArm"]] = rotations.exp(np.array([0.0, -0.5, 0.4]))
    goal = posed(ROOT + [0.05, 0.0, 0.03], raised).joints
    arm = [INDEX[n] for n in ("leftLowerArm", "leftHand")]
    everything = np.arange(N_JOINTS)
    term = JointTerm(BODY, seen_at(goal, 0.0, everything)).trusting
    root, there = settled(term, ROOT, local)
    reached = posed(root, there).joints
    assert np.linalg.norm(reached[arm] - goal[arm], axis=1).max() < 0.05


def with_leg_turned(turn_rad: float) -> Floats:
    """The left one, about its length: its outline stays as it is."""
    local = relaxed()
    turn = rotations.exp(np.array([0.0, turn_rad, 0.0]))
    local[INDEX["leftUpperLeg"]] = rotations.multiply(local[INDEX["leftUpperLeg"]], turn)
    return local


@pytest.mark.parametrize("turn_rad", [-2.6, -1.0, 1.5])
def test_a_foot_turns_to_where_its_toes_were_seen_wherever_it_stands(turn_rad: float) -> None:
    local, turned = relaxed(), with_leg_turned(turn_rad)
    ankle, toes = INDEX["leftFoot"], INDEX["leftToes"]
    seen_m = posed(ROOT + [0.0, 0.0, 0.4], local).joints
    term = JointTerm(BODY, seen_at(seen_m, 0.0, FEET, CROSSING))
    root, there = settled(term, ROOT, turned)
    foot_m, now_m = (
        joints_m[toes] - joints_m[ankle] for joints_m in (seen_m, posed(root, there).joints)
    )
    assert abs(np.cross(foot_m, now_m)[1]) < 0.3 * foot_m @ now_m
    # more than what a shoe's pixels say against it
    assert system(term, ROOT, turned)[0] - system(term, ROOT, local)[0] > 80.0


def test_feet_that_one_camera_saw_are_not_turned() -> None:
    seen = seen_at(posed(ROOT, relaxed()).joints, 0.0, FEET, CROSSING)
    both, alone = (
        system(JointTerm(BODY, rays), ROOT, with_leg_turned(1.5))[0] for rays in (seen, seen[:1])
    )
    assert alone < 72.0 < 0.4 * both  # two outliers at most: the toes' place and their depth


def test_rays_of_two_cameras_cross_at_the_joint() -> None:
    there_m = posed(ROOT, relaxed()).joints
    places_m, sd_m = JointTerm(BODY, seen_at(there_m, 0.0, FEET, CROSSING)).crossings
    assert places_m[FEET] == pytest.approx(there_m[FEET], abs=1e-4)
    assert (sd_m[FEET] < 0.3).all()
    assert np.isinf(np.delete(sd_m, FEET)).all()


def test_a_joint_that_is_elsewhere_hardly_pulls() -> None:
    local = relaxed()
    joints_m = posed(ROOT, local).joints
    moved = joints_m.copy()
    moved[INDEX["leftHand"], 0] += 1.5
    _, _, robust = system(JointTerm(BODY, seen_at(moved)), ROOT, local)
    _, _, trusting = system(JointTerm(BODY, seen_at(moved)).trusting, ROOT, local)
    assert np.abs(robust).max() < 0.02 * np.abs(trusting).max()


@pytest.mark.parametrize("turn_rad", [0.0, 0.9, -2.5, 3.0])
def test_which_way_the_trunk_was_seen_to_face(turn_rad: float) -> None:
    local = relaxed()
    turned = local.copy()
    turned[0] = rotations.exp(np.array([0.0, turn_rad, 0.0]))
    goal = posed(ROOT, turned).joints
    trunk = np.array([INDEX[s + j] for j in ("UpperArm", "UpperLeg") for s in ("left", "right")])
    here_m = posed(ROOT, local).joints
    assert JointTerm(BODY, seen_at(goal, 0.0, trunk)).turn_rad(here_m) == pytest.approx(
        turn_rad, abs=0.02
    )
    nothing = seen_at(goal, 0.0, np.array([], dtype=int))
    assert JointTerm(BODY, nothing).turn_rad(here_m) == 0.0


def test_a_joint_is_as_far_off_its_keypoint_as_it_lies_beside_the_ray() -> None:
    joints_m = posed(ROOT, relaxed()).joints
    term = JointTerm(BODY, seen_at(joints_m, cameras=CROSSING))
    assert np.allclose(term.off_keypoints_m(joints_m), 0.0, atol=1e-9)
    hand = INDEX["leftHand"]
    moved_m = joints_m.copy()
    moved_m[hand] += [0.0, 0.12, 0.0]  # both cameras look on nearly level
    off_m = term.off_keypoints_m(moved_m)
    assert 0.1 < off_m[hand] <= 0.12
    assert not np.delete(off_m, hand).max() > 1e-9


def test_a_camera_that_shows_no_joint_does_not_hide_that_another_contradicts() -> None:
    joints_m = posed(ROOT, relaxed()).joints
    nothing, far = seen_at(joints_m, which=SEEN[:0])[0], seen_at(joints_m, off=1.0)[1]
    term = JointTerm(BODY, [nothing, far])
    assert term.worst_off_sds2(joints_m) == JointTerm(BODY, [far]).worst_off_sds2(joints_m) > 10.0
    assert JointTerm(BODY, [nothing]).worst_off_sds2(joints_m) == 0.0
