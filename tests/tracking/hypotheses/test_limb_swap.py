"""Legs that slipped onto each other, and what is known of where legs are."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.priors.pose_prior import unusual_legs
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.regions import region_labels
from mocapd.tracking.hypotheses.limb_swap import (
    are_crossed,
    twist_rad,
    with_hips_below_chest,
    with_legs_exchanged,
)
from tests.geometry.rigs import ring

BODY = build_model(1.75, full_body())
FITTER = Fitter(BODY, region_labels(BODY), ring(2), [2, 2], FitParams())
FEET = [INDEX["leftFoot"], INDEX["rightFoot"]]


def standing(yaw_rad: float, spread_rad: float) -> MotionState:
    """Somebody upright whose legs are turned outwards, or over each other."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, yaw_rad, 0.0]))
    for side, mirror in (("left", 1.0), ("right", -1.0)):
        turned = np.array([0.0, 0.0, mirror * spread_rad])
        local[INDEX[side + "UpperLeg"]] = rotations.exp(turned)
    space = BODY.space
    return MotionState(
        BODY.rest_m[0].copy(), local, np.zeros(BODY.n_pose), np.ones(BODY.n_shape), initial_information(space)
    )  # fmt: skip


@given(st.floats(-3.0, 3.0), st.floats(0.0, 0.5))
def test_legs_beside_each_other_are_not_crossed_whichever_way_somebody_looks(
    yaw_rad: float, spread_rad: float
) -> None:
    assert not are_crossed(FITTER.joints(standing(yaw_rad, spread_rad))[0])


@given(st.floats(-3.0, 3.0), st.floats(0.3, 0.5))
def test_crossed_legs_are_exchanged_where_they_are(yaw_rad: float, spread_rad: float) -> None:
    state = standing(yaw_rad, -spread_rad)
    joints = FITTER.joints(state)[0]
    assert are_crossed(joints)
    other = FITTER.joints(with_legs_exchanged(FITTER, state))[0]
    assert not are_crossed(other)
    # each ankle is where the other was, but for how long a leg that is bent alike can be
    apart = np.linalg.norm(other[FEET] - joints[FEET[::-1]], axis=1)
    assert apart.max() < 0.1


@given(st.floats(-3.0, 3.0), st.floats(0.8, 2.5), st.sampled_from([-1.0, 1.0]))
def test_hips_that_were_left_behind_come_below_the_chest_and_feet_stay(
    yaw_rad: float, twist: float, way: float
) -> None:
    state = standing(yaw_rad, 0.2)
    state.local_xyzw[INDEX["spine"]] = rotations.exp(np.array([0.0, way * twist, 0.0]))
    joints, globals_ = FITTER.joints(state)
    assert np.isclose(twist_rad(globals_), way * twist, atol=1e-6)
    turned, globals_turned = FITTER.joints(with_hips_below_chest(FITTER, state))
    assert np.isclose(twist_rad(globals_turned), 0.0, atol=1e-6)
    assert not are_crossed(turned)
    upper = [INDEX[bone] for bone in ("upperChest", "leftHand", "rightHand", "head")]
    assert np.allclose(turned[upper], joints[upper], atol=0.05)
    # a foot of either leg is where one was, but for the width of the hips
    hips_m = np.linalg.norm(joints[INDEX["leftUpperLeg"]] - joints[INDEX["rightUpperLeg"]])
    apart = np.linalg.norm(turned[FEET][:, None] - joints[FEET][None], axis=2)
    assert apart.min(axis=1).max() < hips_m + 0.02


def test_exchanging_twice_changes_little() -> None:
    state = standing(0.4, -0.4)
    again = with_legs_exchanged(FITTER, with_legs_exchanged(FITTER, state))
    assert np.allclose(FITTER.joints(again)[0], FITTER.joints(state)[0], atol=0.02)


def test_knees_that_bend_forwards_are_more_unusual_than_those_that_bend_back() -> None:
    straight = standing(0.0, 0.05).local_xyzw
    costs = []
    for bend in (0.8, -0.8):
        local = straight.copy()
        local[INDEX["leftLowerLeg"]] = rotations.exp(np.array([bend, 0.0, 0.0]))
        costs.append(unusual_legs(local))
    assert costs[0] < costs[1]


def test_both_legs_count_alike() -> None:
    bent = [standing(0.0, 0.05).local_xyzw.copy() for _ in range(2)]
    for local, side, mirror in zip(bent, ("left", "right"), (1.0, -1.0), strict=True):
        local[INDEX[side + "UpperLeg"]] = rotations.exp(
            np.array([-0.9, mirror * 0.2, mirror * 0.3])
        )
    assert np.isclose(unusual_legs(bent[0]), unusual_legs(bent[1]))
    moved = replace(standing(0.0, 0.05), local_xyzw=bent[0])
    assert not are_crossed(FITTER.joints(moved)[0])
