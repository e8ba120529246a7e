"""Builds the published tracker from the calibration."""

from mocapd.calibration.calibration_record import Calibration
from mocapd.published.hecht2009.face.lbp_cascade import frontal_faces
from mocapd.published.hecht2009.params import Params
from mocapd.published.hecht2009.tracker import Hecht2009Tracker
from mocapd.tracking.tracker_inputs import calibrated_rig, stature_m
from mocapd.tracking.tracking_state import TrackingStateParams


def build_hecht2009_tracker(
    calibration: Calibration,
    params: Params | None = None,
    tracking: TrackingStateParams | None = None,
) -> Hecht2009Tracker:
    """The tracker. Raises ConfigError naming what is missing."""
    rig, stature = calibrated_rig(calibration), stature_m(calibration)
    return Hecht2009Tracker(rig, stature, frontal_faces(), params or Params(), tracking)
