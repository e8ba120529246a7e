"""Where joints were seen elsewhere a fit begins there, in pictures that are classified beside that pose.

Of regions that look alike only what is drawn tells which pixel is whose, so in pictures that were classified beside the
predicted pose any other one loses: an arm before a trunk of its colour could not come loose.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.limb_candidates import turned_rad2
from mocapd.fit.limbs.two_bones import LIMBS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.tracking.hypotheses.seen_pose import WHOLE, SeenPoseParams, starts_as_seen
from mocapd.types import Floats

_LONG_BONES = np.array([bone for limb in LIMBS.values() for bone in (limb.upper, limb.lower)])


@dataclass(frozen=True, slots=True)
class Anew:
    """What a pose is judged by that is not the predicted one: views of it, which draws it, and then its terms."""

    classified: Callable[[MotionState], list[View]]
    measured: Callable[[MotionState, Sequence[View]], Sequence[Term]]


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A fit, what it was judged by, and the parts of the body that were found elsewhere; tried: whether others were."""

    fit: Fit
    views: Sequence[View]
    terms: Sequence[Term]
    changed: tuple[str, ...] = ()
    tried: bool = False


def tried_as_seen(
    fitter: Fitter,
    now: Judged,
    dt_s: float,
    joints: JointTerm,
    anew: Anew,
    params: SeenPoseParams,
    motion: Floats | None,
) -> Judged:
    """The cheapest of the present fit and those that begin where the joints were seen. motion: of every fit, where an upper
    body leads and legs alone may change."""
    held = [one for one in now.terms if not one.is_measured and one is not joints]
    gained = params.gain

    def cost_of(fit: Fit) -> float:
        return float(joints.costs(fitter.joints(fit.state)[0]).sum())

    here_xyzw = now.fit.state.local_xyzw[_LONG_BONES]
    starts = starts_as_seen(fitter, now.fit, joints, held, params, legs_alone=motion is not None)
    best = replace(now, tried=True) if starts else now
    for start, changed in starts:
        views = anew.classified(start)
        if len(views) < len(now.views):
            continue
        terms = anew.measured(start, views)
        fit = fitter.fit(
            start, views, dt_s, params.fit_iterations, rendered=True, fine=1, motion=motion, terms=terms
        )  # fmt: skip
        away_rad2 = float(turned_rad2(fit.state.local_xyzw[None, _LONG_BONES], here_xyzw)[0])
        gain = now.fit.cost_for_any_pose - fit.cost_for_any_pose - params.farther * away_rad2
        if WHOLE in changed:  # the joints asked for it: the pictures must bear it without them
            gain -= cost_of(now.fit) - cost_of(fit)
        if gain > gained:
            best, gained = Judged(fit, views, terms, changed, tried=True), gain
    return best
