"""A thigh that hangs turns less about itself than one that is lifted."""

import numpy as np
import pytest

from mocapd.body.joint_limits import X, Y, Z, from_swing_twist
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.body.soft_limits import soft_limit

LIMITS = full_body().limits
SIDES = {"left": 1.0, "right": -1.0}


def with_thigh(side: str, forwards_deg: float, outwards_deg: float, twist_deg: float) -> Floats:
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    angles_deg = np.array([-forwards_deg, SIDES[side] * twist_deg, SIDES[side] * outwards_deg])
    local[INDEX[side + "UpperLeg"]] = from_swing_twist(np.radians(angles_deg), Y)
    return local


def excess_deg(side: str, local_xyzw: Floats) -> Floats:
    group = list(LIMITS.joint).index(INDEX[side + "UpperLeg"])
    excess_rad: Floats = soft_limit(LIMITS, local_xyzw)[1][group]
    return np.degrees(excess_rad) * SIDES[side]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(
    ("forwards_deg", "twist_deg", "beyond_deg"),
    [(0.0, 50.0, 0.0), (0.0, 70.0, 15.0), (20.0, 110.0, 55.0), (0.0, -70.0, -15.0), (80.0, 105.0, 0.0),
     (47.5, 90.0, 7.5)],
)  # fmt: skip
def test_how_far_a_thigh_may_turn_depends_on_how_far_it_is_lifted(
    side: str, forwards_deg: float, twist_deg: float, beyond_deg: float
) -> None:
    excess = excess_deg(side, with_thigh(side, forwards_deg, 0.0, twist_deg))
    np.testing.assert_allclose(excess[[X, Y, Z]], [0.0, beyond_deg, 0.0], atol=1e-6)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(
    "angles_deg", [(40.0, 10.0, 95.0), (10.0, 5.0, 70.0), (35.0, -10.0, 120.0)]
)
def test_derivatives_equal_differences(side: str, angles_deg: tuple[float, float, float]) -> None:
    local, thigh = with_thigh(side, *angles_deg), INDEX[side + "UpperLeg"]
    group, step_rad = list(LIMITS.joint).index(thigh), 1e-5
    derivative = soft_limit(LIMITS, local)[2][group]
    for k in range(3):
        ends = []
        for sign in (1.0, -1.0):
            turned = local.copy()
            turned[thigh] = rotations.multiply(
                rotations.exp(sign * step_rad * np.eye(3)[k]), local[thigh]
            )
            ends.append(soft_limit(LIMITS, turned)[1][group])
        difference = (ends[0] - ends[1]) / (2 * step_rad)
        np.testing.assert_allclose(derivative[:, k], difference, atol=1e-6)


def test_both_sides_turn_alike_and_hanging_less_than_lifted() -> None:
    left, right = (list(LIMITS.joint).index(INDEX[side + "UpperLeg"]) for side in SIDES)
    np.testing.assert_allclose(LIMITS.hanging_rad[left], -LIMITS.hanging_rad[right][::-1])
    for group in (left, right):
        least, most = LIMITS.hanging_rad[group]
        assert least >= LIMITS.lower_rad[group, Y]
        assert most <= LIMITS.upper_rad[group, Y]
