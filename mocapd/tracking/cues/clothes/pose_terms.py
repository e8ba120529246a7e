"""Terms of a fit besides the classified regions: the floor, stereo distances and keypoints."""

from collections.abc import Collection, Sequence

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry.camera_model import project
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.keypoints.keypoint_detection import KeypointDetectors
from mocapd.tracking.cues.stereo.stereo_distances import GreyPicture, stereo_distance_terms

_FEET = [INDEX[side + bone] for side in SIDES for bone in ("Foot", "Toes")]


class PoseTerms:
    """The terms of a body's fits; a network for each camera."""

    def __init__(self, model: BodyModel, cameras: int, params: ClothesParams) -> None:
        """cameras: how many there are."""
        self.floor = FloorTerm(model, params.floor)
        self._soft_floor = FloorTerm(model, params.floor_before_crossing_views)
        self.joints = KeypointDetectors(cameras, model.stature_m, params.joints)
        self._params = params.distances

    def measure(
        self,
        fitter: Fitter,
        drawn: MotionState,
        views: Sequence[View],
        grey: GreyPicture,
        frame_index: int,
        only: Collection[int] = (),
    ) -> tuple[Term, ...]:
        """The floor, and distances of all regions or of these only, of a body that was drawn last into every view."""
        distances = stereo_distance_terms(
            fitter, drawn, views, grey, frame_index, self._params, only
        )
        floor = self._soft_floor if self._show_feet(fitter, drawn, views) else self.floor
        return (floor, *distances)

    @staticmethod
    def _show_feet(fitter: Fitter, drawn: MotionState, views: Sequence[View]) -> bool:
        """Whether views that cross show both feet, so that the pictures say how high they are."""
        if fitter.has_small_baseline(drawn, views):
            return False
        feet_m, showing = fitter.joints(drawn)[0][_FEET], 0
        for view in views:
            camera = fitter.drawings[view.index].camera
            feet_px = project(camera, feet_m)
            showing += bool(((feet_px >= 0.0) & (feet_px < camera.size_px)).all())
        return showing > 1
