"""Hypothesis search for an arm that disagrees with the pictures: sample, score and refine other poses."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from mocapd.body.joint_limits import from_swing_twist
from mocapd.body.pose_space import SIDES, PoseSpace
from mocapd.fit.fit_params import LimbSearchParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.arm_samples import Arm, arm_of
from mocapd.fit.limbs.hand_target_poses import bones_to_rotations, hand_target_poses, limb_bones_to
from mocapd.fit.limbs.limb_candidates import best_poses, candidates, part, spread, turned_rad2
from mocapd.fit.limbs.limb_fits import cheapest_fit, with_limb
from mocapd.fit.limbs.limb_scores import has_depths, score_arms_and_hands, score_hand_places
from mocapd.fit.motion_state import MotionState
from mocapd.fit.priors.pose_prior import arm_motions, unusualness
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.types import Floats

_LIBRARY = 2048
_EXCHANGE_ITERATIONS = 4  # both arms start farther from the optimum than a sampled one


class ArmSearch:
    """Tries other poses of arms that the pictures do not confirm."""

    def __init__(self, fitter: Fitter, params: LimbSearchParams) -> None:
        self.fitter, self.params = fitter, params
        self.arms = {side: arm_of(fitter.model, fitter.labels, side) for side in SIDES}
        self._library = {side: arm_library(fitter.model.space, _LIBRARY, side) for side in SIDES}
        u = spread(_LIBRARY)
        near = np.where(np.arange(_LIBRARY) % 2, 1.4, 0.6)[:, None]
        self._usual = arm_motions()
        self._cloud = (2.0 * u - 1.0) * near * np.array([1.0, 1.0, 1.0, 0.5, 1.2, 0.5])

    def rehearse(self, state: MotionState, views: Sequence[View]) -> None:
        """Warm up: compile or load the search's kernels, which ordinary frames do not reach, before the first
        uncertain arm."""
        for side, arm in self.arms.items():
            tries = candidates(
                self.fitter, state, arm, views, self._cloud[:1], self._library[side][:1]
            )
            score_arms_and_hands(self.fitter, state, arm, views, tries, 0.0, 0.0)
        with_arms_exchanged(self.fitter, state, self.arms)

    def improve(
        self,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        turn: int,
        terms: Sequence[Term] = (),
        learn_shape: bool = False,
    ) -> tuple[Fit, tuple[str, ...]]:
        """A better fit, if another pose of an uncertain arm gives one, and the sides that changed.

        turn: a running number; each turn tries another part of the low-discrepancy sets; terms: of every fit.
        """
        p = self.params
        small = self.fitter.has_small_baseline(fit.state, views)
        if not any(is_uncertain(side, fit, p, small) for side in self.arms):
            return fit, ()
        changed = []
        empty = p.empty_small_baseline if small else p.empty
        refit = partial(
            self.fitter.fit, views=views, dt_s=dt_s, iterations=3, learn_shape=learn_shape, fine=1, terms=terms
        )  # fmt: skip
        exchanges = bool(p.exchange_turns) and turn % p.exchange_turns == 0 and has_depths(views)
        for side, arm in self.arms.items():
            if not is_uncertain(side, fit, p, small):
                continue
            tries = self._candidates(fit.state, arm, views, turn)
            scores, hands = self._scores(fit.state, arm, views, tries, empty)
            best = best_poses(tries[:, 1:], scores, p.arm_fits)
            starts = [with_limb(fit.state, arm, tries[n]) for n in best]
            cost = partial(self._cost, arm, tries[0], views, empty)
            least = self._cost_with_hand(arm, tries[0], hands[0], fit) - p.arm_gain
            better = cheapest_fit(fit, starts, refit, cost, least)
            if better is not fit:
                fit = better
                changed.append(side)
        if exchanges:
            start = with_arms_exchanged(self.fitter, fit.state, self.arms)
            far = partial(refit, iterations=_EXCHANGE_ITERATIONS)
            least = self._cost_of_both(fit) - p.arm_gain
            exchanged = cheapest_fit(fit, [start], far, self._cost_of_both, least)
            if exchanged is not fit:
                return exchanged, SIDES
        return fit, tuple(changed)

    def _candidates(self, state: MotionState, arm: Arm, views: Sequence[View], turn: int) -> Floats:
        """Local rotations (N,3,4) of collar, upper arm and forearm to try; the first is the present pose."""
        p = self.params
        cloud = part(self._cloud, turn, p.arm_cloud)
        library = part(self._library[arm.side], turn, p.arm_library)
        tries = candidates(self.fitter, state, arm, views, cloud, library)
        reaching = hand_target_poses(self.fitter, state, arm, views, p.arm_reaches, turn)
        return np.concatenate([tries, reaching])

    def _scores(
        self, state: MotionState, arm: Arm, views: Sequence[View], tries: Floats, empty: float
    ) -> tuple[Floats, Floats]:
        """Image score of each hypothesis and its hand, less its penalties, and that of the hand alone (N,) [work px]."""
        p = self.params
        arms, hands = score_arms_and_hands(
            self.fitter, state, arm, views, tries, p.farther_px, empty
        )
        unusual = unusualness(tries, self._usual[arm.side])
        return arms - p.unusual_px * unusual + p.hand_px * hands, hands

    def _cost(
        self, arm: Arm, here_xyzw: Floats, views: Sequence[View], empty: float, fit: Fit
    ) -> float:
        """Cost of a fit, with the prior on its arm pose (3,4) and the score of its hand."""
        pose = fit.state.local_xyzw[arm.chain[:3]][None]
        hand_px = score_hand_places(self.fitter, fit.state, arm, views, pose, empty)[0]
        return self._cost_with_hand(arm, here_xyzw, hand_px, fit)

    def _cost_with_hand(self, arm: Arm, here_xyzw: Floats, hand_px: float, fit: Fit) -> float:
        """The same, of a hand that scores so."""
        there = fit.state.local_xyzw[arm.chain[:3]]
        price = self._price(arm.side, there, here_xyzw)
        return fit.cost_for_any_pose + price - self.params.hand_cost * float(hand_px)

    def _cost_of_both(self, fit: Fit) -> float:
        """Cost of a fit, with the prior on both arm poses."""
        local = fit.state.local_xyzw
        unusual = sum(self._unusual(side, local[arm.chain[:3]]) for side, arm in self.arms.items())
        return fit.cost_for_any_pose + self.params.unusual_cost * unusual

    def _price(self, side: str, there_xyzw: Floats, here_xyzw: Floats) -> float:
        """Prior cost of an arm pose (3,4): unusual, or far from the present pose."""
        p = self.params
        unusual = self._unusual(side, there_xyzw)
        away_rad2 = float(turned_rad2(there_xyzw[None, 1:], here_xyzw[1:])[0])
        return p.unusual_cost * unusual + p.farther_px * away_rad2

    def _unusual(self, side: str, pose_xyzw: Floats) -> float:
        """`unusualness` of one pose (3,4)."""
        return float(unusualness(pose_xyzw[None], self._usual[side])[0])


def is_uncertain(
    side: str, fit: Fit, params: LimbSearchParams, small_baseline: bool = False
) -> bool:
    """Whether the pictures confirm too little of an arm, or show an object well in front of the body."""
    least = params.uncertain_arm_small_baseline if small_baseline else params.uncertain_arm
    return fit.confirmed_arms[side] < least or fit.nearer_px > params.nearer_px


@cache  # a tracker has three searches, and another one for each wearer's clothes
def arm_library(space: PoseSpace, size: int, side: str) -> Floats:
    """Poses (size,3,4) of one arm spread evenly over its joint limits (Halton), the collar at rest. Shared: not to be
    changed."""
    limits = space.limits
    upper, fore = space.group(side + "UpperArm"), space.group(side + "LowerArm")
    u = spread(size)
    out = np.tile(rotations.IDENTITY_XYZW, (size, 3, 1))
    for place, group, span in ((1, upper, slice(0, 3)), (2, fore, slice(3, 6))):
        low, high = limits.lower_rad[group], limits.upper_rad[group]
        angles = low + (high - low) * u[:, span]
        out[:, place] = from_swing_twist(angles, int(limits.axis[group]))
    return out


def with_arms_exchanged(fitter: Fitter, state: MotionState, arms: Mapping[str, Arm]) -> MotionState:
    """Each hand where the other one is, or as near as it reaches, with the elbow near the other's: in a side view one arm may
    slip onto the other. arms: both, by side."""
    joints_m, globals_ = fitter.joints(state)
    exchanged = replace(state, velocity=np.zeros_like(state.velocity))
    for side, its in (SIDES, SIDES[::-1]):
        arm, other = arms[side], arms[its]
        shoulder, chain = joints_m[arm.chain[1]], arm.chain[:3]
        elbow, hand = joints_m[other.chain[2:4]]
        upper, lower = (bone[:, 0] for bone in limb_bones_to(hand[None], joints_m, globals_, arm))
        nearest = [np.linalg.norm(shoulder + upper - elbow, axis=1).argmin()]
        poses = bones_to_rotations(
            upper[nearest], lower[nearest], joints_m, globals_, arm, state.local_xyzw[chain]
        )
        exchanged = with_limb(exchanged, arm, poses[0])
    return exchanged
