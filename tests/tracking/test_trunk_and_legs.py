"""One body of two fits: trunk and arms are the shirt's, legs and neck keep their direction in the world."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import (
    INDEX,
    N_JOINTS,
    global_from_local,
    joint_positions,
    standard_skeleton,
)
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.geometry import rotations
from mocapd.tracking.track_state import upper_body_state
from mocapd.tracking.trunk_and_legs import (
    LOWER_BONES,
    freeze_legs,
    join_bodies,
    replace_upper_body,
    with_straight_legs,
)
from mocapd.types import Floats, Pose
from tests.body.random_poses import random_local, random_root

WHOLE, UPPER = build_model(1.75, full_body()), build_model(1.75)
SKELETON = standard_skeleton(1.75)
UPPER_BONES = np.setdiff1d(np.arange(N_JOINTS), LOWER_BONES)
_FIRST = [INDEX[name] for name in ("neck", "leftUpperLeg", "rightUpperLeg")]


def body(seed: int) -> MotionState:
    rng = np.random.default_rng(seed)
    return MotionState(
        random_root(seed), random_local(seed, 0.4), rng.normal(size=WHOLE.n_pose),
        rng.uniform(0.9, 1.1, WHOLE.n_shape), initial_information(WHOLE.space) * (1.0 + seed),
    )  # fmt: skip


def in_world(state: MotionState) -> Floats:
    return global_from_local(SKELETON, state.local_xyzw)


def places(state: MotionState) -> Floats:
    return joint_positions(SKELETON, Pose(state.root_m, in_world(state)))


def test_the_trunk_is_the_shirts_and_the_legs_point_as_the_clothes_show_them() -> None:
    below, shirt = body(1), body(2)
    both = join_bodies(below, upper_body_state(shirt, UPPER))
    np.testing.assert_array_equal(both.root_m, shirt.root_m)
    np.testing.assert_allclose(
        np.abs((both.local_xyzw * shirt.local_xyzw).sum(axis=1))[UPPER_BONES], 1.0
    )
    np.testing.assert_allclose(
        np.abs((in_world(both) * in_world(below)).sum(axis=1))[LOWER_BONES], 1.0
    )
    assert np.allclose(places(both)[INDEX["leftHand"]], places(shirt)[INDEX["leftHand"]])
    for first, last in (
        ("neck", "head"),
        ("leftUpperLeg", "leftFoot"),
        ("rightUpperLeg", "rightToes"),
    ):
        a, b = INDEX[first], INDEX[last]
        assert np.allclose(places(both)[b] - places(both)[a], places(below)[b] - places(below)[a])


def test_along_the_line_of_sight_of_one_camera_the_body_is_where_the_whole_of_it_is() -> None:
    below, shirt, ray = body(1), body(2), np.array([0.6, 0.0, 0.8])
    both = join_bodies(below, upper_body_state(shirt, UPPER), ray)
    moved_m = both.root_m - shirt.root_m
    np.testing.assert_allclose(ray @ both.root_m, ray @ below.root_m)
    np.testing.assert_allclose(np.cross(moved_m, ray), 0.0, atol=1e-12)
    hand = INDEX["leftHand"]
    np.testing.assert_allclose(places(both)[hand] - places(shirt)[hand], moved_m)


def test_velocity_and_proportions_are_of_who_sees_them() -> None:
    below, shirt = body(1), body(2)
    both = join_bodies(below, upper_body_state(shirt, UPPER))
    n, s = UPPER.n_pose, UPPER.n_shape
    for one, of_shirt, of_clothes, at in (
        (both.velocity, shirt.velocity, below.velocity, n),
        (both.factors, shirt.factors, below.factors, s),
    ):
        np.testing.assert_array_equal(one[:at], of_shirt[:at])
        np.testing.assert_array_equal(one[at:], of_clothes[at:])
    np.testing.assert_array_equal(both.information[:s, :s], shirt.information[:s, :s])
    np.testing.assert_array_equal(both.information[s:, s:], below.information[s:, s:])


def test_what_is_put_together_leaves_the_parts_as_they_were() -> None:
    below, shirt = body(1), body(2)
    upper = upper_body_state(shirt, UPPER)
    for one in (join_bodies(below, upper), replace_upper_body(below, upper)):
        one.velocity[:], one.factors[:] = 0.0, 0.0
    assert below.velocity.all()
    assert upper.velocity.all()
    assert below.factors.all()


def test_legs_that_nobody_sees_stay_as_they_were_known() -> None:
    now, known = body(1), body(2)
    still = freeze_legs(now, known, UPPER.n_pose)
    np.testing.assert_array_equal(still.local_xyzw[LOWER_BONES], known.local_xyzw[LOWER_BONES])
    np.testing.assert_array_equal(still.local_xyzw[UPPER_BONES], now.local_xyzw[UPPER_BONES])
    assert not still.velocity[UPPER.n_pose :].any()
    np.testing.assert_array_equal(still.velocity[: UPPER.n_pose], now.velocity[: UPPER.n_pose])


def test_a_shirt_alone_has_legs_that_hang_straight() -> None:
    shirt = upper_body_state(body(2), UPPER)
    out = with_straight_legs(shirt, body(1))
    assert out.local_xyzw[LOWER_BONES] == pytest.approx(
        np.tile(rotations.IDENTITY_XYZW, (len(LOWER_BONES), 1))
    )
    np.testing.assert_array_equal(out.root_m, shirt.root_m)
    np.testing.assert_array_equal(out.local_xyzw[UPPER_BONES], shirt.local_xyzw[UPPER_BONES])
