"""Make the tracker without a shirt from what is known of rig and person."""

from dataclasses import replace

from mocapd.calibration.record import Calibration
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.section import FlexSection
from mocapd.trackers.flex.tracker import FlexTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams


def build_flex_tracker(
    calibration: Calibration,
    section: FlexSection | None = None,
    tracking: TrackingStateParams | None = None,
) -> FlexTracker:
    """The tracker as a user set it. Raises ConfigError naming what is missing."""
    section = section if section is not None else FlexSection()
    usual = Params()
    params = replace(
        usual,
        live_explained=section.live_explained,
        start=replace(usual.start, accept_explained=section.accept_explained),
    )
    return FlexTracker(known_rig(calibration), stature_m(calibration), params, tracking)
