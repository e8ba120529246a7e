"""Make the published tracker from what is known of rig and person."""

from mocapd.calibration.calibration_record import Calibration
from mocapd.trackers.flex_paper.params import Params
from mocapd.trackers.flex_paper.tracker import FlexPaperTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.vision.face.lbp_cascade import frontal_faces


def build_flex_paper_tracker(
    calibration: Calibration,
    params: Params | None = None,
    tracking: TrackingStateParams | None = None,
) -> FlexPaperTracker:
    """The tracker. Raises ConfigError naming what is missing."""
    rig, stature = known_rig(calibration), stature_m(calibration)
    return FlexPaperTracker(rig, stature, frontal_faces(), params or Params(), tracking)
