"""A limb that moved far from its prediction is fitted again, to pictures that are classified about the fit."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.regions import region_labels
from mocapd.tracking.hypotheses.base import ScoredFit
from mocapd.tracking.hypotheses.hypothesis_tests import MovedLimbs
from tests.geometry.rigs import ring
from tests.tracking.hypotheses.standing_body import BODY, context, drawn, standing

pytestmark = pytest.mark.kernels

DT_S = 1.0 / 30.0


def with_arm(rad: float) -> MotionState:
    state = standing(0.0, 0.1)
    local = state.local_xyzw.copy()
    local[INDEX["leftUpperArm"]] = rotations.exp(np.array([0.0, 0.0, rad]))
    return replace(state, local_xyzw=local)


@dataclass
class Situation:
    """Cameras all around somebody whose pictures were classified about the predicted arm, though they show another."""

    cameras: int = 3
    predicted: MotionState = field(default_factory=lambda: with_arm(0.0))
    true: MotionState = field(default_factory=lambda: with_arm(0.5))

    def __post_init__(self) -> None:
        self.fitter = Fitter(
            BODY, region_labels(BODY), ring(self.cameras), [2] * self.cameras, FitParams()
        )
        self.about: list[MotionState] = []  # what pictures were classified about

    def test(self, trunk_prior: bool = False) -> tuple[ScoredFit, ScoredFit]:
        """The fit before, and what came of it."""
        stale = drawn(self.predicted, self.fitter)
        near = self.fitter.fit(with_arm(0.3), drawn(self.true, self.fitter), DT_S, 1)
        cost = self.fitter.fit(near.state, stale, DT_S, 1).cost
        now = ScoredFit(replace(near, cost=cost), stale, ())
        prior = np.zeros((BODY.n_pose, BODY.n_pose)) if trunk_prior else None
        at = replace(
            context(self.fitter, self._classify), trunk_prior=prior, predicted=self.predicted
        )
        return now, MovedLimbs().test(now, at)

    def _classify(self, about: MotionState) -> list[View]:
        self.about.append(about)
        return drawn(self.true, self.fitter)

    def hand_off_m(self, state: MotionState) -> float:
        here, there = (self.fitter.joints(one)[0][INDEX["leftHand"]] for one in (state, self.true))
        return float(np.linalg.norm(here - there))


def test_it_is_found_where_pictures_of_the_fit_show_it() -> None:
    situation = Situation()
    now, found = situation.test()
    assert situation.about == [now.fit.state]
    assert found.views is not now.views
    assert situation.hand_off_m(found.fit.state) < 0.5 * situation.hand_off_m(now.fit.state)


def test_a_limb_that_is_where_it_was_predicted_costs_no_second_fit() -> None:
    situation = Situation(predicted=with_arm(0.5))
    now, found = situation.test()
    assert found is now
    assert not situation.about


@pytest.mark.parametrize(("cameras", "trunk_prior"), [(2, False), (3, True)])
def test_neither_two_cameras_nor_a_trunk_from_the_shirt_have_one(
    cameras: int, trunk_prior: bool
) -> None:
    situation = Situation(cameras)
    now, found = situation.test(trunk_prior)
    assert found is now
