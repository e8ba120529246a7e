"""The body tracker of each profile, built as the registry builds it, from a pose database that is at hand."""

from collections.abc import Callable

from mocapd.calibration.calibration_record import Calibration
from mocapd.each import Each, in_turn
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.trackers.registry import Resources, build
from mocapd.tracking.base import Tracker, frozen_clock
from mocapd.tracking.body_tracker import BodyTracker
from mocapd.tracking.build import build_body_tracker


def auto_tracker(known: Calibration, database: PoseDatabase) -> BodyTracker:
    """By the shirt and by clothes."""
    return build_body_tracker("auto", known, database, clothes=True)


def shirt_tracker(known: Calibration, database: PoseDatabase) -> BodyTracker:
    """By the shirt alone."""
    return build_body_tracker("shirt", known, database, clothes=False)


def markerless_tracker(
    known: Calibration, each: Each = in_turn, now_ns: Callable[[], int] = frozen_clock
) -> BodyTracker:
    """By any clothes."""
    return build_body_tracker("markerless", known, None, clothes=True, each=each, now_ns=now_ns)


def hecht2009_tracker(known: Calibration) -> Tracker:
    """The published one by any clothes."""
    return build("hecht2009", known, Resources())


def rao_hodges_tracker(known: Calibration) -> Tracker:
    """The published one by the visual hull."""
    return build("rao_hodges", known, Resources())
