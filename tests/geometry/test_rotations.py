"""Group axioms, logarithm and exponential at their delicate places, derivatives by differences."""

from collections.abc import Callable

import numpy as np
import pytest
import scipy  # its submodules load on first use: they take long to import
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mocapd.geometry import rotations
from mocapd.types import Floats

AXES = arrays(float, 3, elements=st.floats(-1.0, 1.0)).filter(lambda v: np.linalg.norm(v) > 0.1)
# ordinary angles, and those where series and branches meet
ANGLES = st.one_of(
    st.floats(0.0, np.pi),
    st.sampled_from([0.0, 1e-300, 1e-12, 1e-7, 0.99e-4, 1.01e-4, 2e-5, np.pi - 1e-7, np.pi]),
)


def _rotvec(axis: Floats, angle_rad: float) -> Floats:
    return np.asarray(axis / np.linalg.norm(axis) * angle_rad)


ROTVECS = st.builds(_rotvec, AXES, ANGLES)
QUATS = ROTVECS.map(rotations.exp)
VECTORS = arrays(float, 3, elements=st.floats(-10.0, 10.0))


def same(a: Floats, b: Floats, tolerance_rad: float = 1e-7) -> bool:
    return bool((rotations.angle_rad(a, b) < tolerance_rad).all())


@settings(max_examples=60)  # of several rotations each
@given(QUATS, QUATS, QUATS)
def test_group_axioms(a: Floats, b: Floats, c: Floats) -> None:
    product = rotations.multiply(a, b)
    assert abs(np.linalg.norm(product) - 1.0) < 1e-12  # closure
    assert same(rotations.multiply(a, rotations.IDENTITY_XYZW), a)
    assert same(rotations.multiply(rotations.IDENTITY_XYZW, a), a)
    assert same(rotations.multiply(a, rotations.inverse(a)), rotations.IDENTITY_XYZW)
    left = rotations.multiply(product, c)
    right = rotations.multiply(a, rotations.multiply(b, c))
    assert np.allclose(left, right, atol=1e-12)
    undone = rotations.multiply(rotations.inverse(b), rotations.inverse(a))
    assert np.allclose(rotations.inverse(product), undone, atol=1e-12)


@settings(max_examples=60)  # of several rotations each
@given(QUATS, QUATS, VECTORS, VECTORS)
def test_it_acts_on_vectors_as_rotations_do(a: Floats, b: Floats, v: Floats, u: Floats) -> None:
    both = rotations.rotate(rotations.multiply(a, b), v)
    assert np.allclose(both, rotations.rotate(a, rotations.rotate(b, v)), atol=1e-11)
    assert rotations.rotate(a, v) @ rotations.rotate(a, u) == pytest.approx(v @ u, abs=1e-10)
    crossed = np.cross(rotations.rotate(a, v), rotations.rotate(a, u))
    assert np.allclose(crossed, rotations.rotate(a, np.cross(v, u)), atol=1e-10)


@given(ROTVECS, VECTORS)
def test_all_forms_agree_with_scipy(r: Floats, v: Floats) -> None:
    expected = scipy.spatial.transform.Rotation.from_rotvec(r)
    q = rotations.exp(r)
    assert same(q, expected.as_quat())
    assert q[3] >= 0.0
    assert np.allclose(rotations.rotate(q, v), expected.apply(v), atol=1e-10)
    assert np.allclose(rotations.to_matrix(q), expected.as_matrix(), atol=1e-12)
    assert same(rotations.from_matrix(expected.as_matrix()), q)


@given(ROTVECS)
def test_log_undoes_exp(r: Floats) -> None:
    back = rotations.log(rotations.exp(r))
    angle = np.linalg.norm(r)
    assert np.linalg.norm(back) <= np.pi + 1e-12
    if angle < np.pi - 1e-6:
        assert np.allclose(back, r, rtol=1e-9, atol=1e-15)
    else:  # half a turn either way is the same rotation
        assert min(np.abs(back - r).max(), np.abs(back + r).max()) < 1e-5


@pytest.mark.parametrize("angle_rad", [1e-300, 1e-20, 1e-12, 1e-7, 1e-5, 0.999e-4, 1.001e-4, 1e-3])
def test_small_rotations_keep_their_digits(angle_rad: float) -> None:
    r = _rotvec(np.array([0.3, -0.5, 0.8]), angle_rad)
    assert np.allclose(rotations.exp(r)[:3], 0.5 * r, rtol=angle_rad**2 + 1e-12, atol=0.0)
    assert np.allclose(rotations.log(rotations.exp(r)), r, rtol=1e-12, atol=0.0)
    turned = rotations.angle_rad(rotations.exp(r), rotations.IDENTITY_XYZW)
    assert turned == pytest.approx(angle_rad, rel=1e-12)


@given(AXES, st.floats(-4.0 * np.pi, 4.0 * np.pi))
def test_more_than_a_turn_is_the_rest_of_it(axis: Floats, angle_rad: float) -> None:
    expected = scipy.spatial.transform.Rotation.from_rotvec(_rotvec(axis, angle_rad)).as_quat()
    assert same(rotations.exp(_rotvec(axis, angle_rad)), expected)


@given(QUATS)
def test_matrices_at_half_turns_too_go_there_and_back(q: Floats) -> None:
    R = rotations.to_matrix(q)
    assert np.allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert same(rotations.from_matrix(R), q)


@given(QUATS, QUATS, st.floats(0.0, 1.0))
def test_slerp_goes_evenly_along_the_shortest_arc(a: Floats, b: Floats, u: float) -> None:
    whole = float(rotations.angle_rad(a, b))
    between = rotations.slerp(a, b, u)
    assert rotations.angle_rad(a, between) == pytest.approx(u * whole, abs=1e-6)
    assert rotations.angle_rad(between, b) == pytest.approx((1.0 - u) * whole, abs=1e-6)
    assert same(rotations.slerp(a, b, 0.0), a)
    assert same(rotations.slerp(a, b, 1.0), b, 1e-6)


@given(QUATS, VECTORS, AXES)
def test_the_derivative_of_a_turned_vector_is_the_cross_product(
    q: Floats, v: Floats, axis: Floats
) -> None:
    h = 1e-6

    def turned(step: float) -> Floats:
        return rotations.rotate(rotations.multiply(rotations.exp(step * axis), q), v)

    difference = (turned(h) - turned(-h)) / (2.0 * h)
    assert np.allclose(difference, np.cross(axis, rotations.rotate(q, v)), atol=1e-7)


@pytest.mark.parametrize("batch", [(), (1,), (3, 1, 2)])
def test_batches_are_their_elements(batch: tuple[int, ...]) -> None:
    rng = np.random.default_rng(7)
    r, s = rng.standard_normal((2, *batch, 3))
    v = rng.standard_normal((*batch, 3))
    q, p = rotations.exp(r), rotations.exp(s)
    u = rng.uniform(size=batch)
    results: dict[str, tuple[Floats, Callable[[tuple[int, ...]], Floats]]] = {
        "multiply": (rotations.multiply(q, p), lambda i: rotations.multiply(q[i], p[i])),
        "rotate": (rotations.rotate(q, v), lambda i: rotations.rotate(q[i], v[i])),
        "log": (rotations.log(q), lambda i: rotations.log(q[i])),
        "to_matrix": (rotations.to_matrix(q), lambda i: rotations.to_matrix(q[i])),
        "angle": (rotations.angle_rad(q, p), lambda i: rotations.angle_rad(q[i], p[i])),
        "slerp": (rotations.slerp(q, p, u), lambda i: rotations.slerp(q[i], p[i], u[i])),
        "from_matrix": (
            rotations.from_matrix(rotations.to_matrix(q)),
            lambda i: rotations.from_matrix(rotations.to_matrix(q[i])),
        ),
    }
    for name, (whole, one) in results.items():
        assert whole.shape[: len(batch)] == batch, name
        for i in np.ndindex(batch):
            assert np.allclose(whole[i], one(i), atol=1e-14), name
