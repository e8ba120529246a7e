"""A body tracker of a profile, made from what is known of rig, wearer and shirt."""

from collections.abc import Callable
from dataclasses import dataclass, field

from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.each import Each, in_turn
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.base import no_time_passes
from mocapd.tracking.body_tracker import BodyTracker, BodyTrackerParams
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.tracking.known import known_rig, stature_m
from mocapd.tracking.tracking_state import TrackingStateParams
from mocapd.vision.face.lbp_cascade import frontal_faces


@dataclass(frozen=True, slots=True)
class ProfileParams:
    """The numbers of the tracker and of its cues; other ones than usual are for studies."""

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
    now_ns: Callable[[], int] = no_time_passes,
) -> BodyTracker:
    """A tracker of this profile: by the shirt where there is a pose database, by clothes where that is said. now_ns: see
    `registry.Resources`. Raises ConfigError naming what is missing."""
    p = params if params is not None else ProfileParams()
    rig, stature = known_rig(calibration), stature_m(calibration)
    by_shirt = by_clothes = backgrounds = None
    if clothes:
        by_clothes = ClothesCue(rig, stature, p.clothes, frontal_faces(), each, now_ns)
        backgrounds = [one.background for one in by_clothes.cameras.each]
    if database is not None:
        known = calibration.shirt or ShirtColours()
        colours = colour_model(known.model)
        W = white_balances(known.white_balance, colours)
        by_shirt = ShirtCue(rig, stature, colours, W, database, p.shirt, each, backgrounds)
    return BodyTracker(name, rig, stature, by_shirt, by_clothes, p.body, tracking, each)
