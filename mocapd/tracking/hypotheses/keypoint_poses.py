"""The keypoint hypothesis: where keypoints disagree with the fit, further fits start at their pose.

Regions of the same colour are separated only by the rendered pose. So the pictures are classified again about each start
pose: with the classification of the predicted pose, an arm before a trunk of its colour could not move away from it.
"""

from mocapd.fit.terms.joint_term import JointTerm
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit
from mocapd.tracking.hypotheses.best_start import best_start
from mocapd.tracking.hypotheses.keypoint_starts import (
    KeypointPoseParams,
    fit_to_keypoints,
    keypoint_starts,
)


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
            now = best_keypoint_pose(
                now, at, joints, p, self._reversed_looks >= p.reversed_looks, crossing
            )
        return now


def best_keypoint_pose(
    now: ScoredFit,
    at: HypothesisContext,
    joints: JointTerm,
    params: KeypointPoseParams,
    is_reversed: bool = False,
    each_alone: bool = False,
) -> ScoredFit:
    """The cheapest of the present fit and those that start at the keypoints. is_reversed: these alone say that the body faces
    the other way; each_alone: see `keypoint_starts`, not where views hide the depth of a limb."""
    fitter = at.solvers.fitter
    held = [one for one in now.terms if not one.is_measured and one is not joints]
    starts = keypoint_starts(
        fitter, now.fit, joints, held, params, at.trunk_prior is not None, each_alone
    )
    return best_start(
        now, at, starts, params.fit_iterations, params.gain, params.farther, None if is_reversed else joints
    )  # fmt: skip
