"""The interface of a hypothesis: an alternative pose, tested against the pictures of one frame set."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.tracking.cues.clothes.region_merge import RegionSolvers
from mocapd.tracking.ticks import Ticks
from mocapd.types import Floats

WHOLE = "whole"  # as a part that changed: all of the body


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
