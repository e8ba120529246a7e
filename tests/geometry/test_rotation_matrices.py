"""Rotation matrices against quaternions and by differences."""

import numpy as np

from mocapd.geometry import rotations
from mocapd.geometry.rotations import cross_matrices, exp_matrices, left_jacobians

VECTORS = np.concatenate([np.random.default_rng(2).normal(size=(5, 3)), [[1e-9, 0, 0]]])


def test_rotation_vectors_turn_as_quaternions_do() -> None:
    expected = rotations.to_matrix(rotations.exp(VECTORS))
    np.testing.assert_allclose(exp_matrices(VECTORS), expected, atol=1e-12)
    np.testing.assert_allclose(exp_matrices(VECTORS[0]), expected[0], atol=1e-12)


def test_cross_matrices_are_cross_products() -> None:
    a, b = np.random.default_rng(3).normal(size=(2, 4, 3))
    np.testing.assert_allclose(np.einsum("nij,nj->ni", cross_matrices(a), b), np.cross(a, b))


def test_left_jacobians_are_differences() -> None:
    h = 1e-6
    for axis in np.eye(3):
        ahead, behind = exp_matrices(VECTORS + h * axis), exp_matrices(VECTORS - h * axis)
        slope = (ahead - behind) / (2 * h)
        turning = left_jacobians(VECTORS) @ axis
        np.testing.assert_allclose(
            slope, cross_matrices(turning) @ exp_matrices(VECTORS), rtol=1e-6, atol=1e-8
        )
