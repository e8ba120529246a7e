"""A foot that was left behind when the person turned round, and one that the pictures show."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.base import ScoredFit
from mocapd.tracking.hypotheses.twisted_legs import TwistedLegs, twisted_sides
from tests.tracking.hypotheses.standing_body import FITTER, context, drawn, standing

pytestmark = pytest.mark.kernels

DT_S = 1.0 / 30.0


def with_left_leg_turned(rad: float) -> MotionState:
    state = standing(0.0, 0.1)
    local = state.local_xyzw.copy()
    leg = INDEX["leftUpperLeg"]
    local[leg] = rotations.multiply(local[leg], rotations.exp(np.array([0.0, rad, 0.0])))
    return replace(state, local_xyzw=local)


def toes_off_m(state: MotionState, true: MotionState) -> float:
    here, there = (FITTER.joints(one)[0][INDEX["leftToes"]] for one in (state, true))
    return float(np.linalg.norm(here - there))


def outcome(held: MotionState, true: MotionState) -> tuple[ScoredFit, ScoredFit, int]:
    """The fit at `held` to pictures of `true`, the outcome, and how often pictures were classified again."""
    views = drawn(true)
    again: list[MotionState] = []

    def classify(about: MotionState) -> list[View]:
        again.append(about)
        return drawn(true)

    near = FITTER.fit(held, views, DT_S, 1)
    now = ScoredFit(replace(near, state=held), views, ())
    return now, TwistedLegs().test(now, context(FITTER, classify)), len(again)


def test_a_foot_that_was_left_behind_is_set_straight() -> None:
    true = with_left_leg_turned(0.0)
    now, found, _ = outcome(with_left_leg_turned(2.6), true)
    assert toes_off_m(now.fit.state, true) > 0.2
    assert toes_off_m(found.fit.state, true) < 0.05
    assert found.changed == ("left_leg",)


def test_a_foot_that_points_where_a_foot_can_costs_no_second_fit() -> None:
    state = with_left_leg_turned(0.7)
    now, found, again = outcome(state, state)
    assert found is now
    assert again == 0


def test_either_leg_is_twisted_the_same_way_and_a_bent_one_is_not_judged() -> None:
    local = with_left_leg_turned(2.0).local_xyzw
    assert twisted_sides(local) == ["left"]
    mirrored = local.copy()
    for bone in ("UpperLeg", "LowerLeg", "Foot"):
        mirrored[INDEX["right" + bone]] = local[INDEX["left" + bone]] * [1.0, -1.0, -1.0, 1.0]
    assert twisted_sides(mirrored) == ["left", "right"]
    bent = local.copy()
    bent[INDEX["leftLowerLeg"]] = rotations.exp(np.array([1.2, 0.0, 0.0]))
    assert not twisted_sides(bent)
