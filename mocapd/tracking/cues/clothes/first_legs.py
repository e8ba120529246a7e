"""The first legs and head below a trunk that the shirt carries, of a wearer whose clothes are not known yet.

Keypoints need no background, so they find the legs of somebody who has not moved yet. Where a leg's are unsure, the
silhouette decides, as far as the background behind it was seen.
"""

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.pose_terms import PoseTerms
from mocapd.tracking.cues.clothes.wearer_appearance import WearerAppearance
from mocapd.tracking.hypotheses.base import ScoredFit
from mocapd.tracking.ticks import Ticks
from mocapd.types import Floats

_CAMERAS = 2  # that are sure of knees and ankles, where there are so many
LEGS = [INDEX[side + bone] for side in SIDES for bone in ("LowerLeg", "Foot")]


class FirstLegs:
    """Finds them, and teaches the wearer's appearance."""

    def __init__(
        self,
        silhouettes: Fitter,
        terms: PoseTerms,
        appearance: WearerAppearance,
        cameras: CameraViews,
        params: ClothesParams,
    ) -> None:
        """silhouettes: a fitter whose body has one region."""
        self._silhouettes, self._terms, self._params = silhouettes, terms, params
        self._appearance, self._cameras = appearance, cameras

    def find(
        self,
        start: MotionState,
        dt_s: float,
        trunk_prior: Floats,
        iterations: int,
        is_new: bool,
        ticks: Ticks,
    ) -> ScoredFit | None:
        """A fit of legs and head below the trunk of `start`, which is marked in the pictures; None without evidence.

        trunk_prior (n_pose,n_pose): information of `start`; is_new: no legs were found a moment ago, so they are tried for
        only now and then.
        """
        p = self._params
        if is_new and ticks.due(p.first_keypoints_s):
            found = self._by_keypoints(start, dt_s, trunk_prior, iterations)
            if found is not None:
                return found
        if is_new and not ticks.due(p.first_silhouettes_s):
            return None
        views = self._cameras.silhouettes(start)
        if not views:
            return None
        fit = self._silhouettes.fit(
            start, views, dt_s, iterations, fine=1, motion=trunk_prior, terms=(self._terms.floor,)
        )  # fmt: skip
        if fit.explained >= p.learn_explained:
            self._appearance.learn_first(fit.state, self._cameras)
        return ScoredFit(fit, views, ())

    def _by_keypoints(
        self, start: MotionState, dt_s: float, trunk_prior: Floats, iterations: int
    ) -> ScoredFit | None:
        """By keypoints alone, then by the appearance learned from that; None if a leg's are unsure."""
        cameras, floor = self._cameras, self._terms.floor
        pose = self._pose_by_keypoints(start, dt_s, trunk_prior)
        if pose is None:
            return None
        cameras.forget_background(pose)
        self._appearance.learn_first(pose, cameras)
        views = cameras.classify(pose)
        if not views:
            return None
        fit = self._appearance.fitter.fit(
            pose, views, dt_s, iterations, rendered=True, motion=trunk_prior, terms=(floor,)
        )  # fmt: skip
        return ScoredFit(fit, views, ())

    def _pose_by_keypoints(
        self, start: MotionState, dt_s: float, trunk_prior: Floats
    ) -> MotionState | None:
        p, cameras, fitter = self._params.keypoint_start, self._cameras, self._silhouettes
        pose = start
        for _ in range(p.looks):
            detect = self._terms.joints.detector(fitter, pose, cameras)
            found = self._terms.joints.term(fitter.model, fitter.each(detect, cameras.present))
            if not found:
                return None
            joints = found[0]
            sure = joints.cameras_sure_of(LEGS, self._params.first_spread_m)
            if sure.min() < min(_CAMERAS, len(cameras.present)):
                return None
            held = (self._terms.floor, joints.trusting)
            pose = fitter.fit(start, (), dt_s, p.iterations, motion=trunk_prior, terms=held).state
            if joints.worst_off_sds2(fitter.joints(pose)[0]) > p.off_sds2:
                return None
        return pose
