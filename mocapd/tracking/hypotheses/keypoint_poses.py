"""The keypoint hypothesis: where keypoints disagree with the fit, for limbs or a facing direction, further fits start at
their pose.

Regions of the same colour are separated only by the rendered pose. So the pictures are classified again about each start
pose: with the classification of the predicted pose, an arm before a trunk of its colour could not move away from it.

Where the rays of three cameras and more cross, a limb that is not there is tried there, whatever its keypoints cost: each
costs a bounded number of pixels, and a limb's own pixels may be many more.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from mocapd.body.skeleton import INDEX, OTHER_SIDE
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.motion_state import MotionState, turned_about_vertical
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.tracking.cues.keypoints.keypoint_consensus import LEAST_CAMERAS
from mocapd.tracking.cues.keypoints.limbs_at_keypoints import (
    limbs_off_crossings,
    with_limbs_at_keypoints,
)
from mocapd.tracking.hypotheses.base import (
    WHOLE,
    HypothesisContext,
    ScoredFit,
    cheapest,
    refits,
)
from mocapd.types import Floats

_CROSSINGS_S = 2 * TICK_S  # between tries of limbs where rays cross, in sets with new keypoints
_LEGS = [j for name, one in LIMBS.items() if name.endswith("leg") for j in (one.lower, one.end)]


@dataclass(frozen=True, slots=True)
class KeypointPoseParams:
    """When a limb or the whole body is refitted at its keypoints."""

    limb_cost: float = 25.0  # of its joints, more than there [disagreeing pixels]
    whole_cost: float = 150.0
    turned_rad: float = 0.6  # yaw error above which the body is turned first
    reversed_rad: float = 2.4  # the same, above which the body faces the other way
    reversed_looks: int = 3  # in a row that say so, where views cross: colours learned from a reversed body confirm it
    iterations: int = 6  # of the fit to the keypoints alone
    fit_iterations: int = 4  # of a fit to the pictures from there
    loose_s: float = 0.3  # the prior is as weak as a prediction over this time
    gain: float = 5.0  # cost decrease needed to accept it [disagreeing pixels]
    # further decrease needed for limbs that are farther away, before two cameras [disagreeing pixels/rad^2]
    farther: float = 5.0


def keypoint_starts(
    fitter: Fitter,
    fit: Fit,
    keypoints: JointTerm,
    held: Sequence[Term],
    params: KeypointPoseParams,
    legs_alone: bool = False,
    each_alone: bool = False,
    at_crossings: bool = False,
) -> list[tuple[MotionState, tuple[str, ...]]]:
    """Start poses with the parts that change: with the limbs that are far from their keypoints, and with the whole body.

    held: further terms of the keypoint fit; legs_alone: the rest of the body is fixed; each_alone: also with each of these
    limbs alone, as another may have been seen where it is not; at_crossings: also each limb that is not where its rays
    cross, there.
    """
    p, joints_m = params, fitter.joints(fit.state)[0]
    costs = keypoints.costs(joints_m)
    far = {
        name: costs[[one.lower, one.end]].sum()
        for name, one in LIMBS.items()
        if not legs_alone or name.endswith("leg")
    }
    whole = not legs_alone and costs.sum() > p.whole_cost
    off = limbs_off_crossings(keypoints, joints_m) if at_crossings else ()
    if max(far.values()) <= p.limb_cost and not whole and not off:
        return []
    # a trunk from the shirt has the right sides; so have keypoints that agree with it about the facing direction
    sides_agree = legs_alone and abs(keypoints.turn_rad(joints_m)) < p.turned_rad
    if not sides_agree and legs_exchanged(keypoints, joints_m, costs, p):
        far = {name: cost for name, cost in far.items() if name.endswith("arm")}
    lost = [name for name, cost in far.items() if cost > p.limb_cost or whole]
    starts: list[tuple[MotionState, tuple[str, ...]]] = [
        (with_limbs_at_keypoints(fitter, fit.state, keypoints, (name,)), (name,))
        for name in off
        if name in far
    ]
    if not lost:
        return starts
    there = fit_to_keypoints(fitter, fit.state, keypoints, held, p, lost)
    costs_there = keypoints.costs(fitter.joints(there)[0])
    limbs = tuple(
        name
        for name, cost in far.items()
        if cost - costs_there[[LIMBS[name].lower, LIMBS[name].end]].sum() > p.limb_cost
    )
    choices = [limbs] if limbs else []
    if each_alone and len(limbs) > 1:
        choices += [(name,) for name in limbs if name not in off]
    for chosen in choices:
        local = fit.state.local_xyzw.copy()
        for name in chosen:
            bones = [INDEX[bone] for bone in fitter.model.space.parts[name].groups]
            local[bones] = there.local_xyzw[bones]
        starts.append((replace(fit.state, local_xyzw=local), chosen))
    if whole and costs.sum() - costs_there.sum() > p.whole_cost:
        starts.append((there, (WHOLE,)))
    return starts


def legs_exchanged(
    keypoints: JointTerm, joints_m: Floats, costs: Floats, params: KeypointPoseParams
) -> bool:
    """True if the detected legs match these legs with left and right exchanged."""
    other_m = joints_m.copy()
    other_m[_LEGS] = joints_m[OTHER_SIDE[_LEGS]]
    return bool(costs[_LEGS].sum() - keypoints.costs(other_m)[_LEGS].sum() > params.limb_cost)


def fit_to_keypoints(
    fitter: Fitter,
    state: MotionState,
    keypoints: JointTerm,
    held: Sequence[Term],
    params: KeypointPoseParams,
    limbs: Collection[str] = (),
) -> MotionState:
    """A pose fitted to the keypoints alone from this state; `limbs` start from two-bone IK."""
    turn_rad = keypoints.turn_rad(fitter.joints(state)[0])
    if abs(turn_rad) > params.turned_rad:
        state = turned_about_vertical(state, turn_rad)
    state = with_limbs_at_keypoints(fitter, state, keypoints, limbs)
    terms = (*held, keypoints.trusting)
    return fitter.fit(state, (), params.loose_s, params.iterations, terms=terms).state


class KeypointPoses:
    """See PoseHypothesis."""

    def __init__(self, params: KeypointPoseParams) -> None:
        self._params = params
        self.reset()

    def reset(self) -> None:
        """See PoseHypothesis."""
        self._reversed_looks = 0

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        for joints in at.joints:
            fit_to_keypoints(at.solvers.fitter, now.fit.state, joints, (), self._params)

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """The cheapest of the present fit and those that start at the keypoints. Unchanged without detected keypoints."""
        p, fitter = self._params, at.solvers.fitter
        for joints in at.joints:
            turn_rad = joints.turn_rad(fitter.joints(now.fit.state)[0])
            crossing = not fitter.has_small_baseline(now.fit.state, now.views)
            says_reversed = crossing and abs(turn_rad) > p.reversed_rad
            self._reversed_looks = self._reversed_looks + 1 if says_reversed else 0
            # looks that say so for long are believed beside pictures that deny it
            believed = self._reversed_looks >= p.reversed_looks
            # what rays that cross say of a limb's place does not hang on where it was thought to be
            farther = p.farther if len(joints.rays) < LEAST_CAMERAS else 0.0
            starts = self._starts(now, at, joints, crossing)
            doubted = None if believed else joints
            others = refits(now, at, starts, p.fit_iterations, farther, doubted)
            now = cheapest(now, others, p.gain)
        return now

    def _starts(
        self, now: ScoredFit, at: HypothesisContext, joints: JointTerm, crossing: bool
    ) -> list[tuple[MotionState, tuple[str, ...]]]:
        """See `keypoint_starts`; each limb alone not where views hide its depth."""
        held = [one for one in now.terms if not one.is_measured and one is not joints]
        return keypoint_starts(
            at.solvers.fitter, now.fit, joints, held, self._params, at.trunk_prior is not None, crossing,
            at.ticks.due(_CROSSINGS_S, TICK_S),
        )  # fmt: skip
