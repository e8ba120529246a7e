"""First contact of a moving ball and moving capsules."""

import numpy as np
import pytest

from goalkeeper.core.sweep import TOUCH_M, Capsules, first_contact
from mocapd.types import Floats
from tests.clients.goalkeeper.naive_touch import axis_distance_m


def _still(start: list[float], end: list[float], radius_m: float) -> Capsules:
    a, b = np.array([start]), np.array([end])
    return Capsules(a, a, b, b, np.array([radius_m]), np.array([True]))


@pytest.mark.parametrize("speed_m", [1.0, 100.0, 1e5])
def test_a_fast_ball_does_not_pass_through_a_thin_limb(speed_m: float) -> None:
    limb = _still([-0.2, 1.0, 0.0], [0.2, 1.0, 0.0], 0.02)
    ball = np.array([0.05, 1.0, 0.5 * speed_m])
    contact = first_contact(ball, ball - [0.0, 0.0, speed_m], 0.1, limb)
    assert contact is not None
    touching_m = (0.5 - contact.fraction) * speed_m
    assert touching_m == pytest.approx(0.12, abs=2 * TOUCH_M)
    assert contact.normal == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)


def test_a_limb_that_swings_through_a_ball_at_rest_touches_it() -> None:
    a, b = np.array([[0.0, 1.0, -1.0]]), np.array([[0.0, 1.5, -1.0]])
    swing = Capsules(a, a + [0, 0, 2], b, b + [0, 0, 2], np.array([0.05]), np.array([True]))
    at_rest = np.array([0.0, 1.2, 0.0])
    contact = first_contact(at_rest, at_rest, 0.1, swing)
    assert contact is not None
    assert contact.fraction == pytest.approx((1.0 - 0.15) / 2.0, abs=1e-4)
    assert contact.surface_velocity_m == pytest.approx([0.0, 0.0, 2.0])


def test_limbs_that_are_not_there_stop_nothing() -> None:
    limb = _still([0.0, 1.0, 0.0], [0.0, 1.2, 0.0], 0.05)
    gone = Capsules(
        limb.start_from_m, limb.start_to_m, limb.end_from_m, limb.end_to_m, limb.radii_m,
        np.array([False]),
    )  # fmt: skip
    ball = np.array([0.0, 1.1, 1.0])
    assert first_contact(ball, -ball + [0.0, 2.2, 0.0], 0.1, gone) is None


def test_random_sweeps_agree_with_ten_thousand_looks() -> None:
    rng = np.random.default_rng(5)
    seen = []
    for _ in range(150):
        ball, to = rng.uniform(-0.6, 0.6, (2, 3))
        a, a_to, b, b_to = rng.uniform(-0.6, 0.6, (4, 1, 3))
        radius_m = rng.uniform(0.03, 0.15)
        limb = Capsules(a, a_to, b, b_to, np.array([radius_m]), np.array([True]))
        contact = first_contact(ball, to, 0.1, limb)
        gaps = _gaps(ball, to, limb) - radius_m - 0.1
        least_m = float(gaps.min())
        if abs(least_m) < 3e-4:
            continue
        assert (contact is not None) == (least_m < 0.0)
        if contact is not None:
            first = np.flatnonzero(gaps <= 0.0)[0] / (len(gaps) - 1)
            # a ball that grazes is within TOUCH_M long before it is within nothing
            assert contact.fraction <= first
            assert gaps[round(contact.fraction * (len(gaps) - 1))] < 5e-4
        seen.append(contact is not None)
    assert 30 < sum(seen) < len(seen) - 30


def _gaps(ball: Floats, to: Floats, limb: Capsules) -> Floats:
    """Distance of centre and axis at ten thousand times."""
    t = np.linspace(0.0, 1.0, 10_001)[:, None]
    at = ball + t * (to - ball)
    a = limb.start_from_m[0] + t * (limb.start_to_m[0] - limb.start_from_m[0])
    b = limb.end_from_m[0] + t * (limb.end_to_m[0] - limb.end_from_m[0])
    return axis_distance_m(at, a, b)
