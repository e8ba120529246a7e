"""Limbs of ellipsoids: the inside test against a naive twin, angles to poses and back, and what the weights say."""

import numpy as np
import pytest

from lab.rao_hodges.experiment import STATURE_M, chains, points_in
from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.published.rao_hodges.body_chains import body_chains, place_of, pose_of
from mocapd.published.rao_hodges.limb_weight import ball_samples, match_points, pose_limb
from mocapd.published.rao_hodges.point_cloud import point_cloud
from mocapd.types import Floats, Pose

BENT = np.radians([10.0, -15.0, -40.0, 60.0, -20.0, -8.0, 5.0, 20.0, 15.0, 10.0])
ROOT_R, ROOT_M = np.eye(3), np.array([0.0, 0.95, 0.0])


def volume_m3() -> float:
    return float(4.0 / 3.0 * np.pi * chains()["legs"].arrays.radii_m.prod(axis=1).sum())


def naive_inside(angles: Floats, points: Floats) -> np.ndarray:
    """(E,P) point by point, with rotations multiplied one after the other."""
    chain = chains()["legs"]
    a = chain.arrays
    at: list[Floats] = []
    turned: list[Floats] = []
    out: list[np.ndarray] = []
    for e, parent in enumerate(a.parents):
        R = ROOT_R if parent < 0 else turned[parent]
        joint = (ROOT_M if parent < 0 else at[parent]) + R @ a.joints_m[e]
        for d in range(a.first_dof[e], a.first_dof[e + 1]):
            x, y, z = a.axes[d]
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            R = R @ (
                np.eye(3) + np.sin(angles[d]) * cross + (1 - np.cos(angles[d])) * cross @ cross
            )
        at.append(joint)
        turned.append(R)
        local = ((points - joint) @ R - a.centres_m[e]) / a.radii_m[e]
        out.append((local**2).sum(axis=1) <= 1.0)
    return np.array(out)


def test_shares_are_those_of_points_looked_at_one_by_one() -> None:
    rng = np.random.default_rng(1)
    chain = chains()["legs"]
    points = rng.uniform([-0.5, 0.0, -0.5], [0.5, 1.0, 0.6], (4000, 3))
    particles = BENT + 0.3 * rng.standard_normal((5, 10))
    found = match_points(
        chain, pose_limb(chain, particles, ROOT_R, ROOT_M), point_cloud(points, 1e9)
    )
    for n, angles in enumerate(particles):
        inside = naive_inside(angles, points)
        assert found.inside[n] == pytest.approx(inside.any(axis=0).mean(), abs=1e-3)
        volumes = 4.0 / 3.0 * np.pi * chain.arrays.radii_m.prod(axis=1)
        assert found.full[n] == pytest.approx(inside.sum(axis=1) / (1e9 * volumes), rel=0.1)


def test_the_true_pose_holds_all_points_and_has_no_empty_ellipsoid() -> None:
    chain = chains()["legs"]
    points = points_in(chain, BENT, 3000, np.random.default_rng(2))
    cloud = point_cloud(points, 3000 / volume_m3())
    away = BENT + np.radians([0, 0, 25.0, -20.0, 0, 0, 0, 0, 0, 0])
    found = match_points(chain, pose_limb(chain, np.array([BENT, away]), ROOT_R, ROOT_M), cloud)
    assert found.inside[0] > 0.999
    assert found.full[0].min() > 0.85
    assert found.inside[1] < 0.9
    assert found.weight(1.0)[1] < found.weight(1.0)[0]


def test_only_the_converse_term_sees_an_ellipsoid_that_is_empty() -> None:
    """A foot turned out of the points costs less than the share of its points; an empty one is half a leg's weight."""
    chain = chains()["legs"]
    points = points_in(chain, BENT, 3000, np.random.default_rng(3))
    cloud = point_cloud(points, 3000 / volume_m3())
    away = BENT.copy()
    away[4] -= np.radians(60.0)
    found = match_points(chain, pose_limb(chain, np.array([BENT, away]), ROOT_R, ROOT_M), cloud)
    lost = 1.0 - found.weight(0.0)[1] / found.weight(0.0)[0]
    lost_with_it = 1.0 - found.weight(1.0)[1] / found.weight(1.0)[0]
    assert lost < 0.05
    assert lost_with_it > 2.0 * lost


def test_knees_bend_backwards_and_elbows_forwards() -> None:
    legs, arm = chains()["legs"], chains()["left_arm"]
    knee = np.zeros(10)
    knee[3] = 0.5 * np.pi
    foot = pose_limb(legs, knee, ROOT_R, ROOT_M).joints_m[0, 2]
    assert foot[2] < -0.3
    elbow = np.array([0.0, 0.0, 0.0, 0.5 * np.pi])
    forearm = pose_limb(arm, elbow, ROOT_R, ROOT_M).R[0, 1]
    assert forearm @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 0.0, 1.0], abs=0.05)


def test_angles_of_a_pose_lead_back_to_it() -> None:
    body = body_chains(mean_shape(STATURE_M))
    straight = place_of(Pose(ROOT_M, np.tile([0.0, 0.0, 0.0, 1.0], (len(INDEX), 1))))
    angles = np.concatenate([BENT, np.radians([20.0, -30.0, -50.0, 70.0, -10.0, 25.0, 60.0, 40.0])])
    place = straight.with_limb(slice(0, 18), angles)
    pose = pose_of(body, place)
    again = place_of(pose)
    # a hinge is turned about its bone by the angle that makes it one: none, where it is one
    assert again.angles == pytest.approx(angles, abs=1e-6)
    joints = joint_positions(skeleton_of(body.shape), pose)
    whole = pose_limb(body.whole, angles, place.root_turn, place.root_m)
    for bone, joint in zip(body.whole.bones[3:], whole.joints_m[0, 3:], strict=True):
        assert joints[INDEX[bone]] == pytest.approx(joint, abs=1e-9)


def test_samples_are_spread_evenly_over_the_ball() -> None:
    samples = ball_samples()
    radius = np.linalg.norm(samples, axis=1)
    assert radius.max() < 1.0
    assert np.count_nonzero(radius < 0.5 ** (1 / 3)) == len(samples) // 2
    assert np.abs(samples.mean(axis=0)).max() < 0.1
