"""Builds a body tracker of a profile from the calibration."""

from collections.abc import Callable
from dataclasses import dataclass, field

from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.each import Each, in_turn
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.base import frozen_clock
from mocapd.tracking.body_tracker import BodyTracker, BodyTrackerParams
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.tracking.tracker_inputs import calibrated_rig, stature_m
from mocapd.tracking.tracking_state import TrackingStateParams


@dataclass(frozen=True, slots=True)
class ProfileParams:
    """Parameters of the tracker and of its cues; studies replace the defaults."""

    body: BodyTrackerParams = field(default_factory=BodyTrackerParams)
    shirt: ShirtParams = field(default_factory=ShirtParams)
    clothes: ClothesParams = field(default_factory=ClothesParams)


def build_body_tracker(
    name: str,
    calibration: Calibration,
    database: PoseDatabase | None,
    clothes: bool,
    params: ProfileParams | None = None,
    tracking: TrackingStateParams | None = None,
    each: Each = in_turn,
    now_ns: Callable[[], int] = frozen_clock,
) -> BodyTracker:
    """Builds a tracker with the shirt cue if a pose database is given, and the clothes cue if `clothes`.

    now_ns: see `registry.Resources`. Raises ConfigError if the calibration lacks rig or stature.
    """
    p = params if params is not None else ProfileParams()
    rig, stature = calibrated_rig(calibration), stature_m(calibration)
    by_shirt = by_clothes = backgrounds = None
    if clothes:
        by_clothes = ClothesCue(rig, stature, p.clothes, each, now_ns)
        backgrounds = [camera.background for camera in by_clothes.cameras.each]
    if database is not None:
        shirt = calibration.shirt or ShirtColours()
        colours = colour_model(shirt.model)
        W = white_balances(shirt.white_balance, colours)
        by_shirt = ShirtCue(rig, stature, colours, W, database, p.shirt, each, backgrounds)
    return BodyTracker(name, rig, stature, by_shirt, by_clothes, p.body, tracking, each)
