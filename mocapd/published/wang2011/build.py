"""Builds a tracker of the published method from the calibration and the pose database."""

from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.published.wang2011.params import Params, paper_params
from mocapd.published.wang2011.tracker import Wang2011Tracker
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.tracker_inputs import calibrated_rig, stature_m
from mocapd.tracking.tracking_state import TrackingStateParams


def build_wang2011_tracker(
    calibration: Calibration,
    database: PoseDatabase,
    params: Params | None = None,
    tracking: TrackingStateParams | None = None,
) -> Wang2011Tracker:
    """The tracker, as published where no params are given. Raises ConfigError naming what is missing."""
    shirt = calibration.shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = white_balances(shirt.white_balance, colours, plain=True)
    params = params or paper_params()
    rig = calibrated_rig(calibration)
    return Wang2011Tracker(rig, stature_m(calibration), colours, W, database, params, tracking)
