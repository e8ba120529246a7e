"""The hull end hypothesis: an arm reaches to an end of the visual hull beside the drawn body.

Colours and keypoints may miss an arm that moved fast; silhouettes of three cameras or more show where it is. The pictures are
classified again about each such pose, as for keypoints.
"""

from dataclasses import dataclass, field

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.fit.fit_params import LimbSearchParams
from mocapd.fit.limbs.hand_target_poses import hand_poses
from mocapd.fit.limbs.hull_ends import (
    HullEndParams,
    hull_views,
    rehearse_hull,
    wrist_at_hull_end,
)
from mocapd.fit.limbs.limb_fits import with_limb
from mocapd.fit.limbs.limb_scores import score_arms_and_hands
from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.motion_state import MotionState
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit, best_start
from mocapd.types import Floats


@dataclass(frozen=True, slots=True)
class ReachingParams:
    """When an arm is refitted at an end of the hull."""

    ends: HullEndParams = field(default_factory=HullEndParams)
    iterations: int = 4
    gain: float = 20.0  # by how much the cost must fall [disagreeing pixels]; with 5, arms also reached to moving shadows
    # how much more, for an arm that is farther away [disagreeing pixels/rad^2]
    farther: float = 5.0
    pause_ticks: int = 5  # after a try that failed


class HullEnds:
    """See PoseHypothesis. Remembers when it failed last."""

    def __init__(self, params: ReachingParams, limbs: LimbSearchParams) -> None:
        self._params, self._limbs = params, limbs
        self.reset()

    def reset(self) -> None:
        """See PoseHypothesis."""
        self._next_tick = 0

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis. Nothing with fewer cameras, which never reach these kernels."""
        fitter = at.solvers.fitter
        if len(fitter.drawings) < self._params.ends.cameras:
            return
        rehearse_hull(fitter)
        joints_m, _ = fitter.joints(now.fit.state)
        self._reaching(now, at, "left", joints_m[LIMBS["left_arm"].end])

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis. Unchanged with fewer cameras, and where the shirt places the arms. The body was drawn last into
        every view, so this comes before other hypotheses."""
        p, fitter = self._params, at.solvers.fitter
        few = len(now.views) < p.ends.cameras
        if few or at.trunk_prior is not None or at.ticks.last < self._next_tick:
            return now
        seen = hull_views(fitter, now.views, p.ends)
        if seen is None:
            return now
        for side in SIDES:
            joints_m, _ = fitter.joints(now.fit.state)
            wrist_m = wrist_at_hull_end(fitter, joints_m, side, seen, p.ends)
            if wrist_m is None:
                continue
            starts = [(self._reaching(now, at, side, wrist_m), (f"{side}_arm",))]
            better = best_start(now, at, starts, p.iterations, p.gain, p.farther)
            if better is now:
                self._next_tick = at.ticks.last + p.pause_ticks
            now = better
        return now

    def _reaching(
        self, now: ScoredFit, at: HypothesisContext, side: str, wrist_m: Floats
    ) -> MotionState:
        """The body with an arm's wrist at a place, the elbow where the pictures score best."""
        fitter, state, arm = at.solvers.fitter, now.fit.state, at.solvers.arms.arms[side]
        joints_m, globals_xyzw = fitter.joints(state)
        present = state.local_xyzw[arm.chain[:3]]
        poses = hand_poses(wrist_m[None], joints_m, globals_xyzw, arm, present)
        empty = self._limbs.empty
        scores, _ = score_arms_and_hands(fitter, state, arm, now.views, poses, 0.0, empty)
        return with_limb(state, arm, poses[int(np.argmax(scores))])
