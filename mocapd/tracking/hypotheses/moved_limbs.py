"""A limb that moved far from its prediction: the pictures are classified again about the fit, and fitted again.

Regions of one colour are told apart by the pose about which they are classified. Where the end of a limb was predicted a
hand's width beside where it is, its own pixels pass for its neighbour's: the fit goes part of the way, and falls behind.
"""

import numpy as np

from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit
from mocapd.tracking.hypotheses.best_start import best_start

_ENDS = [limb.end for limb in LIMBS.values()]
_LEAST_VIEWS = 3  # fewer did not gain by it (docs/decisions/one-body.md)
_MOVED_M = 0.06  # of a limb's end beside its prediction, relative to the hips
_ITERATIONS = 4
_GAIN = 5.0  # cost decrease needed to accept it [disagreeing pixels]


class MovedLimbs:
    """See PoseHypothesis."""

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
        return best_start(now, at, [(now.fit.state, now.changed)], _ITERATIONS, _GAIN, 0.0)
