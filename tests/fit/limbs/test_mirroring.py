"""Bones mirrored in depth: to the camera they lie where they lay, and one of them or both lean the other way."""

import numpy as np
import pytest

from mocapd.fit.limbs.limb_search_kernels import mirrored_in_depth, shortest_turn
from mocapd.geometry import rotations
from mocapd.types import Floats

pytestmark = pytest.mark.kernels

EYE = np.array([0.1, 1.2, 3.0])


def test_the_shortest_turn_leads_from_one_direction_to_another() -> None:
    rng = np.random.default_rng(0)
    out = np.empty(4)
    for a, b in rng.normal(0.0, 1.0, (30, 2, 3)):
        shortest_turn(a, b, out)
        turned = rotations.rotate(out, a / np.linalg.norm(a))
        np.testing.assert_allclose(turned, b / np.linalg.norm(b), atol=1e-12)
        across = np.cross(a, b)
        assert abs(out[:3] @ a) < 1e-9 * np.linalg.norm(across)  # no turn about itself


@pytest.mark.parametrize("a", [[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.3, -0.4, 1.0]])
def test_a_direction_is_turned_right_round(a: list[float]) -> None:
    out, there = np.empty(4), np.array(a)
    shortest_turn(there, -there, out)
    np.testing.assert_allclose(rotations.rotate(out, there), -there, atol=1e-6)


def bones_of(
    local: Floats, parent: Floats, lengths_m: tuple[float, float]
) -> tuple[Floats, Floats]:
    """The two bones (3,) of a limb that hangs down in the T-pose."""
    upper = rotations.multiply(parent, local[0])
    lower = rotations.multiply(upper, local[1])
    return tuple(rotations.rotate(q, np.array([0.0, -one, 0.0])) for q, one in zip((upper, lower), lengths_m, strict=True))  # type: ignore[return-value]  # fmt: skip


def test_mirrored_bones_lean_as_far_the_other_way_in_depth() -> None:
    rng = np.random.default_rng(1)
    parent, *local = rotations.exp(rng.normal(0.0, 0.6, (3, 3)))
    lengths_m, hip = (0.44, 0.41), np.array([0.1, 0.9, 0.0])
    a, b = bones_of(np.array(local), parent, lengths_m)
    upper = rotations.multiply(parent, local[0])
    globals_ = np.stack([upper, rotations.multiply(upper, local[1])])
    joints_m, out = np.stack([hip, hip + a, hip + a + b]), np.empty((3, 2, 4))
    mirrored_in_depth(joints_m, globals_, parent, EYE, out)
    ray = (hip + a - EYE) / np.linalg.norm(hip + a - EYE)
    flipped = [bone - 2.0 * (bone @ ray) * ray for bone in (a, b)]
    for one, wanted in zip(out, ((a, flipped[1]), (flipped[0], b), flipped), strict=True):
        for bone, there in zip(bones_of(one, parent, lengths_m), wanted, strict=True):
            np.testing.assert_allclose(bone, there, atol=1e-9)
