"""Alignment finds the transform that was applied, and the best one where there is noise."""

import numpy as np

from mocapd.geometry.rigid_transforms import (
    RigidTransform,
    align_directions,
    align_points,
    nearest_rotation,
)
from mocapd.geometry.rotations import exp_matrices

R = exp_matrices(np.array([0.4, -2.1, 0.9]))
A_FROM_B = RigidTransform(R, np.array([-2.4, 0.1, 1.5]))


def test_a_known_transform_is_recovered() -> None:
    b_m = np.random.default_rng(0).normal(size=(12, 3))
    found = align_points(A_FROM_B.apply(b_m), b_m)
    np.testing.assert_allclose(found.R, A_FROM_B.R, atol=1e-12)
    np.testing.assert_allclose(found.t_m, A_FROM_B.t_m, atol=1e-12)


def test_points_of_a_plane_give_no_reflection() -> None:
    b_m = np.random.default_rng(1).normal(size=(12, 3)) * [1.0, 1.0, 0.0]
    found = align_points(A_FROM_B.apply(b_m), b_m)
    np.testing.assert_allclose(found.R, A_FROM_B.R, atol=1e-9)
    mirrored = align_points(b_m * [1.0, 1.0, -1.0], b_m + [0.0, 0.0, 1.0])
    assert np.linalg.det(mirrored.R) > 0.0


def test_points_without_weight_are_not_asked() -> None:
    b_m = np.random.default_rng(2).normal(size=(12, 3))
    a_m = A_FROM_B.apply(b_m)
    a_m[8:] += 7.0
    weights = np.where(np.arange(12) < 8, 3.0, 0.0)
    np.testing.assert_allclose(align_points(a_m, b_m, weights).R, A_FROM_B.R, atol=1e-12)


def test_no_small_step_from_the_solution_is_better() -> None:
    rng = np.random.default_rng(3)
    b_m = rng.normal(size=(30, 3))
    a_m = A_FROM_B.apply(b_m) + 0.1 * rng.normal(size=(30, 3))
    weights = rng.uniform(0.1, 2.0, 30)

    def cost(one: RigidTransform) -> float:
        return float(weights @ ((one.apply(b_m) - a_m) ** 2).sum(axis=1))

    best = align_points(a_m, b_m, weights)
    for step in 1e-3 * rng.normal(size=(20, 6)):
        beside = RigidTransform(exp_matrices(step[:3]) @ best.R, best.t_m + step[3:])
        assert cost(best) < cost(beside)


def test_directions_give_the_rotation() -> None:
    b = np.random.default_rng(4).normal(size=(5, 3))
    np.testing.assert_allclose(align_directions(b @ R.T, b), R, atol=1e-12)


def test_a_rotation_that_drifted_is_brought_back() -> None:
    drifted = R + 1e-4 * np.random.default_rng(5).normal(size=(3, 3))
    back = nearest_rotation(drifted)
    np.testing.assert_allclose(back @ back.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(back, R, atol=1e-3)
    np.testing.assert_allclose(nearest_rotation(R), R, atol=1e-12)
