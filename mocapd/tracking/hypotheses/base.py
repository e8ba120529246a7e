"""The interface of a hypothesis: an alternative pose, tested against the pictures of one frame set.

`refits` fits again from other poses, with the pictures classified again about each.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.limb_candidates import turned_rad2
from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.tracking.cues.clothes.region_merge import RegionSolvers
from mocapd.tracking.ticks import Ticks
from mocapd.types import Floats

WHOLE = "whole"  # as a part that changed: all of the body
_LONG_BONES = np.array([bone for limb in LIMBS.values() for bone in (limb.upper, limb.lower)])


@dataclass(frozen=True, slots=True)
class PoseEvidence:
    """Evidence for a pose far from the predicted one: its views, which renders it, then its terms."""

    classify: Callable[[MotionState], list[View]]
    measure: Callable[[MotionState, Sequence[View]], Sequence[Term]]


@dataclass(frozen=True, slots=True, eq=False)
class HypothesisContext:
    """The frame set in which hypotheses are tested, dt_s after the last one.

    joints: terms of the detected keypoints, none in most frame sets; trunk_prior: information (n_pose,n_pose) of every fit
    if the shirt places the trunk, so that only legs and head may change; predicted: the body about which the first views were
    classified.
    """

    solvers: RegionSolvers
    dt_s: float
    ticks: Ticks
    joints: Sequence[JointTerm]
    evidence: PoseEvidence
    trunk_prior: Floats | None = None
    predicted: MotionState | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ScoredFit:
    """A fit with its views and terms. changed: parts found away from their prediction."""

    fit: Fit
    views: Sequence[View]
    terms: Sequence[Term]
    changed: tuple[str, ...] = ()


class PoseHypothesis(Protocol):
    """May accumulate evidence between frame sets."""

    def reset(self) -> None:
        """Clears accumulated evidence."""
        ...

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """Runs once what ordinary frames do not reach, so that none has to wait for its kernels."""
        ...

    def test(self, now: ScoredFit, at: HypothesisContext, /) -> ScoredFit:
        """The current fit, or one that the pictures confirm better."""
        ...


def refits(
    now: ScoredFit,
    at: HypothesisContext,
    starts: Sequence[tuple[MotionState, tuple[str, ...]]],
    iterations: int,
    farther: float = 0.0,
    doubted: JointTerm | None = None,
) -> list[tuple[ScoredFit, float]]:
    """Fits from each of `starts`, given with the parts that it changes, and how much less than the present fit each costs
    [disagreeing pixels]; none where fewer cameras see it.

    farther: cost of limbs that are farther away [disagreeing pixels/rad^2]; doubted: keypoints that do not count where all of
    the body changes, since it starts there: the pictures must confirm it without them.
    """
    fitter = at.solvers.fitter
    here_xyzw = now.fit.state.local_xyzw[_LONG_BONES]

    def cost_of(fit: Fit, keypoints: JointTerm) -> float:
        return float(keypoints.costs(fitter.joints(fit.state)[0]).sum())

    out = []
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
        out.append((ScoredFit(fit, views, terms, changed), gain))
    return out


def cheapest(now: ScoredFit, others: Sequence[tuple[ScoredFit, float]], least: float) -> ScoredFit:
    """Of these fits with their gains the one that gains most; the present one, if none gains more than `least`."""
    best, gain = max(others, key=lambda one: one[1], default=(now, least))
    return best if gain > least else now
