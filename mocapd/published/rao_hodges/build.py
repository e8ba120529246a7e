"""Builds the tracker of Rao and Hodges from the calibration."""

from mocapd.calibration.calibration_record import Calibration
from mocapd.published.rao_hodges.params import Params
from mocapd.published.rao_hodges.tracker import RaoHodgesTracker
from mocapd.tracking.tracker_inputs import calibrated_rig, stature_m
from mocapd.tracking.tracking_state import TrackingStateParams


def build_rao_hodges_tracker(
    calibration: Calibration,
    params: Params | None = None,
    tracking: TrackingStateParams | None = None,
) -> RaoHodgesTracker:
    """The tracker. Raises ConfigError naming what is missing."""
    return RaoHodgesTracker(calibrated_rig(calibration), stature_m(calibration), params, tracking)
