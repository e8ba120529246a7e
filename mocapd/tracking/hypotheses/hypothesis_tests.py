"""Runs the pose hypotheses that the solver cannot reach, one after another."""

from dataclasses import replace

import numpy as np

from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.hypotheses.base import (
    HypothesisContext,
    PoseHypothesis,
    ScoredFit,
    cheapest,
    refits,
)
from mocapd.tracking.hypotheses.keypoint_poses import KeypointPoses
from mocapd.tracking.hypotheses.twisted_legs import TwistedLegs

_ENDS = [limb.end for limb in LIMBS.values()]
_LEAST_VIEWS = 3  # fewer did not gain by it (docs/decisions/one-body.md)
_MOVED_M = 0.06  # of a limb's end beside its prediction, relative to the hips
_ITERATIONS = 4
_GAIN = 5.0  # cost decrease needed to accept it [disagreeing pixels]


class ArmPoses:
    """Other arms about one that the pictures hardly confirm, and over its whole range, where no trunk leads that knows them;
    see PoseHypothesis."""

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        at.solvers.arms.rehearse(now.fit.state, now.views)

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        if at.trunk_prior is not None:
            return now
        fit, sides = at.solvers.arms.improve(
            now.fit, now.views, at.dt_s, at.ticks.frame_index, now.terms
        )
        changed = (*now.changed, *(f"{side}_arm" for side in sides))
        return replace(now, fit=fit, changed=changed)


class LegPoses:
    """Other legs; see PoseHypothesis."""

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        at.solvers.legs.rehearse(now.fit.state, now.views)

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        fit, sides = at.solvers.legs.improve(
            now.fit, now.views, at.dt_s, at.ticks.frame_index, now.terms, at.trunk_prior
        )
        return replace(now, fit=fit, changed=(*now.changed, *(f"{side}_leg" for side in sides)))


class MovedLimbs:
    """A limb that moved far from its prediction: the pictures are classified again about the fit, and fitted again.

    Regions of one colour are told apart by the pose about which they are classified. Where the end of a limb was predicted a
    hand's width beside where it is, its own pixels pass for its neighbour's: the fit goes part of the way, and falls behind.
    """

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        if at.trunk_prior is not None or at.predicted is None or len(now.views) < _LEAST_VIEWS:
            return now
        joints = at.solvers.fitter.joints
        here_m, predicted_m = joints(now.fit.state)[0], joints(at.predicted)[0]
        moved_m = (here_m[_ENDS] - here_m[0]) - (predicted_m[_ENDS] - predicted_m[0])
        if np.linalg.norm(moved_m, axis=1).max() <= _MOVED_M:
            return now
        return cheapest(now, refits(now, at, [(now.fit.state, now.changed)], _ITERATIONS), _GAIN)


class HypothesisTests:
    """All hypotheses, in an order where an earlier one may make a later one needless."""

    def __init__(self, params: ClothesParams) -> None:
        self._always: dict[str, PoseHypothesis] = {
            "moved_limbs": MovedLimbs(),
            "keypoint_poses": KeypointPoses(params.keypoint_poses),
            "twisted_legs": TwistedLegs(),
        }
        self._searched: dict[str, PoseHypothesis] = {
            "arm_poses": ArmPoses(),
            "leg_poses": LegPoses(),
        }

    def reset(self) -> None:
        """Resets all hypotheses."""
        for one in (self._always | self._searched).values():
            one.reset()

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        for one in (self._always | self._searched).values():
            one.rehearse(now, at)

    def improve(
        self, now: ScoredFit, at: HypothesisContext, searches: bool, probe: Probe
    ) -> ScoredFit:
        """The fit, or a better one. searches: also test the hypotheses that need no detected keypoints."""
        for name, one in (self._always | self._searched if searches else self._always).items():
            now = one.test(now, at)
            probe(name)
        return now
