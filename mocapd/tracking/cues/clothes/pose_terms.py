"""Terms of a fit besides the classified regions: the floor, stereo distances and keypoints."""

from collections.abc import Collection, Sequence

from mocapd.body.model import BodyModel
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.keypoints.keypoint_detection import KeypointDetectors
from mocapd.tracking.cues.stereo.stereo_distances import GreyPicture, stereo_distance_terms


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
        # pictures say how high feet are where views cross that show both
        is_seen = not fitter.has_small_baseline(drawn, views) and fitter.show_feet(drawn, views)
        floor = self._soft_floor if is_seen else self.floor
        return (floor, *distances)
