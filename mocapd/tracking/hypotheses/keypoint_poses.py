"""The keypoint hypothesis: where keypoints disagree with the fit, further fits start at their pose.

Regions of the same colour are separated only by the rendered pose. So the pictures are classified again about each start
pose: with the classification of the predicted pose, an arm before a trunk of its colour could not move away from it.
"""

from collections.abc import Sequence

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.limb_candidates import turned_rad2
from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.tracking.hypotheses.base import WHOLE, HypothesisContext, ScoredFit
from mocapd.tracking.hypotheses.keypoint_starts import (
    KeypointPoseParams,
    fit_to_keypoints,
    keypoint_starts,
)

_LONG_BONES = np.array([bone for limb in LIMBS.values() for bone in (limb.upper, limb.lower)])


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
        """See `best_keypoint_pose`. Unchanged without detected keypoints."""
        p, fitter = self._params, at.solvers.fitter
        for joints in at.joints:
            turn_rad = joints.turn_rad(fitter.joints(now.fit.state)[0])
            crossing = not fitter.has_small_baseline(now.fit.state, now.views)
            is_reversed = crossing and abs(turn_rad) > p.reversed_rad
            self._reversed_looks = self._reversed_looks + 1 if is_reversed else 0
            now = best_keypoint_pose(now, at, joints, p, self._reversed_looks >= p.reversed_looks)
        return now


def best_keypoint_pose(
    now: ScoredFit,
    at: HypothesisContext,
    joints: JointTerm,
    params: KeypointPoseParams,
    is_reversed: bool = False,
) -> ScoredFit:
    """The cheapest of the present fit and those that start at the keypoints. is_reversed: these alone say that the body faces
    the other way."""
    fitter = at.solvers.fitter
    held = [one for one in now.terms if not one.is_measured and one is not joints]
    starts = keypoint_starts(
        fitter, now.fit, joints, held, params, legs_alone=at.trunk_prior is not None
    )
    return best_start(
        now, at, starts, params.fit_iterations, params.gain, params.farther, None if is_reversed else joints
    )  # fmt: skip


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
