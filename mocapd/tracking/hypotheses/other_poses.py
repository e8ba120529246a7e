"""Poses out of the fit's reach that pictures bear better: hypotheses that are tested one after the other."""

from mocapd.tracking.base import Probe
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.hypotheses.base import Judged, PoseHypothesis, Situation
from mocapd.tracking.hypotheses.foot_heading import FootHeading
from mocapd.tracking.hypotheses.front_back_flip import FrontBackFlip
from mocapd.tracking.hypotheses.keypoint_poses import KeypointPoses
from mocapd.tracking.hypotheses.limb_poses import ArmPoses, LegPoses
from mocapd.tracking.hypotheses.limb_swap import LimbSwap
from mocapd.tracking.hypotheses.pelvis_heading import PelvisHeading
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays


class OtherPoses:
    """All hypotheses, each after those that may make it needless."""

    def __init__(self, params: ClothesParams, stature_m: float, cascade: CascadeArrays) -> None:
        """cascade: of frontal faces."""
        self._always: dict[str, PoseHypothesis] = {
            "keypoint_poses": KeypointPoses(params.seen_pose),
            "pelvis_heading": PelvisHeading(params.pelvis_heading),
            "foot_heading": FootHeading(params.foot_heading),
        }
        self._searched: dict[str, PoseHypothesis] = {
            "arm_poses": ArmPoses(params.limbs),
            "front_back_flip": FrontBackFlip(params.flip, stature_m, cascade),
            "leg_poses": LegPoses(),
            "limb_swap": LimbSwap(params.limb_swap),
        }

    def reset(self) -> None:
        """Nothing was seen of anybody."""
        for one in (self._always | self._searched).values():
            one.reset()

    def rehearse(self, now: Judged, at: Situation, /) -> None:
        """See PoseHypothesis."""
        for one in (self._always | self._searched).values():
            one.rehearse(now, at)

    def improve(self, now: Judged, at: Situation, searches: bool, probe: Probe) -> Judged:
        """The fit, or a better one; searches: whether others are tried than where the network saw joints."""
        for name, one in (self._always | self._searched if searches else self._always).items():
            now = one.test(now, at)
            probe(name)
        return now
