"""Make the tracker without a shirt from what is known of rig and person."""

from collections.abc import Callable

from mocapd.calibration.calibration_record import Calibration
from mocapd.each import Each, in_turn
from mocapd.trackers.base import no_time_passes
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.tracker import FlexTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.vision.face.lbp_cascade import frontal_faces


def build_flex_tracker(
    calibration: Calibration,
    params: Params | None = None,
    tracking: TrackingStateParams | None = None,
    each: Each = in_turn,
    now_ns: Callable[[], int] = no_time_passes,
) -> FlexTracker:
    """The tracker; now_ns: see `registry.Resources`. Raises ConfigError naming what is missing."""
    rig, stature = known_rig(calibration), stature_m(calibration)
    return FlexTracker(rig, stature, params or Params(), tracking, frontal_faces(), each, now_ns)
