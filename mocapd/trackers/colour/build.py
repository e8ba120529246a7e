"""Make a colour tracker from what is known of rig, wearer and shirt, and the pose database."""

from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.each import Each, in_turn
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.trackers.colour.params import Params
from mocapd.trackers.colour.tracker import ColourTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams


def build_colour_tracker(
    calibration: Calibration,
    database: PoseDatabase,
    params: Params | None = None,
    tracking: TrackingStateParams | None = None,
    each: Each = in_turn,
) -> ColourTracker:
    """The tracker. Raises ConfigError naming what is missing."""
    shirt = calibration.shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = white_balances(shirt.white_balance, colours)
    rig = known_rig(calibration)
    return ColourTracker(
        rig, stature_m(calibration), colours, W, database, params or Params(), tracking, each
    )
