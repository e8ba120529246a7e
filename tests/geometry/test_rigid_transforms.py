"""Rigid transforms chain by their names, and each undoes its inverse."""

import numpy as np
import pytest

from mocapd.geometry.rigid_transforms import IDENTITY, RigidTransform, concatenate, stack
from mocapd.geometry.rotations import exp_matrices

RNG = np.random.default_rng(3)


def some(*batch: int) -> RigidTransform:
    return RigidTransform(exp_matrices(RNG.normal(size=(*batch, 3))), RNG.normal(size=(*batch, 3)))


def test_products_chain() -> None:
    a_from_b, b_from_c, points_c = some(), some(), RNG.normal(size=(7, 3))
    np.testing.assert_allclose(
        (a_from_b @ b_from_c).apply(points_c), a_from_b.apply(b_from_c.apply(points_c)), atol=1e-12
    )


def test_an_inverse_leads_back() -> None:
    a_from_b, points = some(), RNG.normal(size=(2, 4, 3))
    np.testing.assert_allclose(a_from_b.inverse().apply(a_from_b.apply(points)), points, atol=1e-12)
    same = a_from_b @ a_from_b.inverse()
    np.testing.assert_allclose(same.R, IDENTITY.R, atol=1e-12)
    np.testing.assert_allclose(same.t_m, IDENTITY.t_m, atol=1e-12)


def test_a_point_is_turned_then_shifted() -> None:
    quarter = RigidTransform(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([5.0, 0, 0]))
    np.testing.assert_allclose(quarter.apply(np.array([1.0, 2.0, 3.0])), [3.0, 1.0, 3.0])
    np.testing.assert_allclose(quarter.rotate(np.array([1.0, 2.0, 3.0])), [-2.0, 1.0, 3.0])


@pytest.mark.parametrize("batch", [(1,), (4,), (2, 3)])
def test_batches_are_their_elements(batch: tuple[int, ...]) -> None:
    a_from_b, b_from_c, points = some(*batch), some(*batch), RNG.normal(size=(*batch, 3))
    product, moved = a_from_b @ b_from_c, a_from_b.apply(points)
    for i in np.ndindex(batch):
        np.testing.assert_allclose(product[i].t_m, (a_from_b[i] @ b_from_c[i]).t_m, atol=1e-12)
        np.testing.assert_allclose(moved[i], a_from_b[i].apply(points[i]), atol=1e-12)


def test_many_transforms_of_the_same_points() -> None:
    a_from_b, points = some(4), RNG.normal(size=(7, 3))
    moved = a_from_b[:, None].apply(points)
    assert moved.shape == (4, 7, 3)
    np.testing.assert_allclose(moved[2], a_from_b[2].apply(points), atol=1e-12)


def test_single_ones_are_stacked_and_batches_joined() -> None:
    one, two = some(), some()
    both = concatenate(stack([one]), stack([two]))
    np.testing.assert_array_equal(both[1].R, two.R)
    assert concatenate(stack([]), both).t_m.shape == (2, 3)
