"""Further fits that start at other poses, with the pictures classified again about each: the cheapest is kept."""

from collections.abc import Sequence

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.limb_candidates import turned_rad2
from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.tracking.hypotheses.base import WHOLE, HypothesisContext, ScoredFit

_LONG_BONES = np.array([bone for limb in LIMBS.values() for bone in (limb.upper, limb.lower)])


def best_start(
    now: ScoredFit,
    at: HypothesisContext,
    starts: Sequence[tuple[MotionState, tuple[str, ...]]],
    iterations: int,
    gained: float,
    farther: float,
    doubted: JointTerm | None = None,
) -> ScoredFit:
    """The cheapest of the present fit and those that start at `starts`, each with the parts that it changes.

    gained: by how much the cost must fall [disagreeing pixels]; farther: how much more it must fall for limbs that are
    farther away [disagreeing pixels/rad^2]; doubted: keypoints that do not count where all of the body changes, since it
    starts there: the pictures must confirm it without them.
    """
    fitter = at.solvers.fitter
    here_xyzw = now.fit.state.local_xyzw[_LONG_BONES]

    def cost_of(fit: Fit, keypoints: JointTerm) -> float:
        return float(keypoints.costs(fitter.joints(fit.state)[0]).sum())

    best = now
    for start, changed in starts:
        views = at.evidence.classify(start)
        if len(views) < len(now.views):
            continue
        terms = at.evidence.measure(start, views)
        fit = fitter.fit(
            start, views, at.dt_s, iterations, rendered=True, fine=1, motion=at.trunk_prior, terms=terms
        )  # fmt: skip
        away_rad2 = float(turned_rad2(fit.state.local_xyzw[None, _LONG_BONES], here_xyzw)[0])
        gain = now.fit.cost_for_any_pose - fit.cost_for_any_pose - farther * away_rad2
        if WHOLE in changed and doubted is not None:
            gain -= cost_of(now.fit, doubted) - cost_of(fit, doubted)
        if gain > gained:
            best, gained = ScoredFit(fit, views, terms, changed), gain
    return best
