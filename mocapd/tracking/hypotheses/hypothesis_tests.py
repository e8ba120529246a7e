"""Runs the pose hypotheses that the solver cannot reach, one after another."""

from mocapd.tracking.base import Probe
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.hypotheses.base import HypothesisContext, PoseHypothesis, ScoredFit
from mocapd.tracking.hypotheses.hull_poses import HullEnds
from mocapd.tracking.hypotheses.keypoint_poses import KeypointPoses
from mocapd.tracking.hypotheses.limb_poses import ArmPoses, LegPoses
from mocapd.tracking.hypotheses.moved_limbs import MovedLimbs


class HypothesisTests:
    """All hypotheses, in an order where an earlier one may make a later one needless."""

    def __init__(self, params: ClothesParams) -> None:
        self._always: dict[str, PoseHypothesis] = {
            # first: it reads what was drawn last, which is the fit that it gets
            "hull_ends": HullEnds(params.hull_ends, params.limbs),
            "moved_limbs": MovedLimbs(),
            "keypoint_poses": KeypointPoses(params.keypoint_poses),
        }
        self._searched: dict[str, PoseHypothesis] = {
            "arm_poses": ArmPoses(),
            "leg_poses": LegPoses(),
        }

    def reset(self) -> None:
        """Resets all hypotheses."""
        for one in (self._always | self._searched).values():
            one.reset()

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        for one in (self._always | self._searched).values():
            one.rehearse(now, at)

    def improve(
        self, now: ScoredFit, at: HypothesisContext, searches: bool, probe: Probe
    ) -> ScoredFit:
        """The fit, or a better one. searches: also test the hypotheses that need no detected keypoints."""
        for name, one in (self._always | self._searched if searches else self._always).items():
            now = one.test(now, at)
            probe(name)
        return now
