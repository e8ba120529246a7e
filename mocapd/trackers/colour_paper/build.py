"""Make a tracker of the published method from what is known of rig, wearer and shirt, and the pose database."""

from mocapd.calibration.record import Calibration, ShirtColours
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.trackers.colour_paper.params import Params, published
from mocapd.trackers.colour_paper.section import ColourPaperSection
from mocapd.trackers.colour_paper.tracker import PaperTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams


def build_paper_tracker(
    calibration: Calibration,
    database: PoseDatabase,
    section: ColourPaperSection | None = None,
    tracking: TrackingStateParams | None = None,
) -> PaperTracker:
    """The tracker as a user set it. Raises ConfigError naming what is missing."""
    section = section if section is not None else ColourPaperSection()
    params = published(section.baseline, section.tolerant)
    return paper_tracker(calibration, database, params, tracking)


def paper_tracker(
    calibration: Calibration,
    database: PoseDatabase,
    params: Params,
    tracking: TrackingStateParams | None = None,
) -> PaperTracker:
    """The tracker with these numbers. Raises ConfigError naming what is missing."""
    shirt = calibration.shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = white_balances(shirt.white_balance, colours, plain=True)
    rig = known_rig(calibration)
    return PaperTracker(rig, stature_m(calibration), colours, W, database, params, tracking)
