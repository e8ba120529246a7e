"""mocapd's world in Unity's axes, against matrices."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mocapd.geometry import rotations
from mocapd.outputs.vrchat.tracker_bundle import cos_sin, unity_euler_deg, unity_position
from mocapd.types import Floats
from tests.outputs.receivers.vrchat import MIRROR, unity_rotation

ANGLE = st.floats(-math.pi, math.pi)
UNIT = st.tuples(*[st.floats(-1, 1)] * 4).map(np.array).filter(lambda q: np.linalg.norm(q) > 0.1)


def about_y(angle_rad: float) -> Floats:
    return rotations.to_matrix(rotations.exp(np.array([0.0, angle_rad, 0.0])))


def test_left_is_left_and_forward_is_forward() -> None:
    still = cos_sin(0.0)
    assert unity_position((1.0, 2.0, 3.0), still) == (-1.0, 2.0, 3.0)
    assert unity_euler_deg((0.0, 0.0, 0.0, 1.0), still) == (0.0, 0.0, 0.0)
    quarter = math.sqrt(0.5)
    # to the left is a negative yaw in Unity, to look up a negative angle about x
    assert unity_euler_deg((0.0, quarter, 0.0, quarter), still) == pytest.approx((0, -90, 0))
    assert unity_euler_deg((-quarter, 0.0, 0.0, quarter), still) == pytest.approx((-90, 0, 0))


@given(UNIT, ANGLE)
@example(np.array([math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]), 2.0)  # a thigh that is lifted level
@example(np.array([-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]), 3.0)
@example(np.array([0.5, 0.5, 0.5, 0.5]), -3.1)
@example(np.array([0.5, -0.5, 0.5, -0.5]), 3.1)
@example(np.array([0.7071, 0.0, 1e-5, 0.7071]), 1.0)
def test_any_rotation_and_any_turn_come_through(q: Floats, turn_rad: float) -> None:
    q = rotations.canonical(q)
    x, y, z, w = q.tolist()
    degrees = unity_euler_deg((x, y, z, w), cos_sin(0.5 * turn_rad))
    assert all(-180.0 <= one <= 180.0 for one in degrees)
    sent = unity_rotation(np.array(degrees, dtype=np.float32).astype(float))
    turned = about_y(turn_rad) @ rotations.to_matrix(q)
    assert np.abs(sent - MIRROR @ turned @ MIRROR).max() < 1e-4


@given(st.tuples(*[st.floats(-5, 5)] * 3), ANGLE)
def test_any_place_and_any_turn_come_through(
    place: tuple[float, float, float], turn_rad: float
) -> None:
    sent = unity_position(place, cos_sin(turn_rad))
    assert np.allclose(sent, MIRROR @ about_y(turn_rad) @ np.array(place))
