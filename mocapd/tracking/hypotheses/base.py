"""What a hypothesis is: another pose than the fitted one, that is tested against the pictures of one frame set."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.tracking.cues.clothes.look import Dressed
from mocapd.tracking.ticks import Ticks
from mocapd.types import Floats, FrameSet

WHOLE = "whole"  # as a part that changed: all of the body


@dataclass(frozen=True, slots=True)
class PoseEvidence:
    """What a pose is judged by that is far from the predicted one: views of it, which draws it, and then its terms."""

    classified: Callable[[MotionState], list[View]]
    measured: Callable[[MotionState, Sequence[View]], Sequence[Term]]


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """The frame set in which hypotheses are tested, dt_s after the last one.

    dressed: fitter and searches of the wearer's look; joints: the terms that saw joints, none in most frame sets; held:
    information (n_pose,n_pose) of every fit where a trunk leads that is known: legs and head alone may change then.
    """

    dressed: Dressed
    dt_s: float
    frames: FrameSet
    ticks: Ticks
    joints: Sequence[JointTerm]
    evidence: PoseEvidence
    held: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A fit, what it was judged by, and the parts of the body that were found elsewhere; tried: whether others were."""

    fit: Fit
    views: Sequence[View]
    terms: Sequence[Term]
    changed: tuple[str, ...] = ()
    tried: bool = False


class PoseHypothesis(Protocol):
    """May remember what spoke for it in frame sets before."""

    def reset(self) -> None:
        """Nothing was seen of anybody."""
        ...

    def rehearse(self, now: Judged, at: Situation, /) -> None:
        """Do once for nothing what ordinary frames do not reach: those must not wait for its kernels."""
        ...

    def test(self, now: Judged, at: Situation, /) -> Judged:
        """The present fit, or one that the pictures bear better."""
        ...
