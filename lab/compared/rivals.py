"""By what each tracker is measured: the method as published, and itself without one of its steps."""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from lab.compared.ablations import FLEX_ABLATIONS, FLEX_PAPER_ABLATIONS
from lab.compared.compare import BASELINE
from mocapd.calibration.record import Calibration
from mocapd.session.side_by_side import each_camera
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.shirt.pose_database.database_file import load_or_build
from mocapd.trackers.base import Tracker
from mocapd.trackers.colour_paper.build import paper_tracker
from mocapd.trackers.colour_paper.params import published
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.tracker import FlexTracker
from mocapd.trackers.flex_paper.params import Params as PaperParams
from mocapd.trackers.flex_paper.tracker import FlexPaperTracker
from mocapd.trackers.known import known_rig, known_shape, stature_m
from mocapd.trackers.registry import Resources, require_known
from mocapd.vision.face.lbp_cascade import frontal_faces

BuildRival = Callable[[Calibration, Resources], Tracker]


def ready_rival(build: BuildRival, resources: Resources, calibration: Calibration) -> ReadyTracker:
    """The rival and the wearer's shape for its first step. Raises ConfigError naming what it lacks."""
    return ReadyTracker(build(calibration, resources), known_shape(calibration))


def _colour_paper(baseline: bool, calibration: Calibration, resources: Resources) -> Tracker:
    require_known("colour_paper", calibration)
    database = load_or_build(resources.cache_dir, progress=resources.progress).database
    return paper_tracker(calibration, database, published(baseline), resources.tracking)


def _flex(
    edit: Callable[[Params], Params], calibration: Calibration, resources: Resources
) -> Tracker:
    require_known("flex", calibration)
    return FlexTracker(
        known_rig(calibration),
        stature_m(calibration),
        edit(Params()),
        resources.tracking,
        frontal_faces(),
        each_camera(),
        resources.now_ns,
    )


def _as_published(params: PaperParams) -> PaperParams:
    return params


def _flex_paper(
    edit: Callable[[PaperParams], PaperParams], calibration: Calibration, resources: Resources
) -> Tracker:
    require_known("flex_paper", calibration)
    return FlexPaperTracker(
        known_rig(calibration),
        stature_m(calibration),
        frontal_faces(),
        edit(PaperParams()),
        resources.tracking,
    )


# By tracker and label.
RIVALS: Mapping[str, Mapping[str, BuildRival]] = MappingProxyType(
    {
        "colour": {
            "paper": partial(_colour_paper, False),
            BASELINE: partial(_colour_paper, True),
        },
        "flex": {
            "paper": partial(_flex_paper, _as_published),
            **{label: partial(_flex, edit) for label, edit in FLEX_ABLATIONS.items()},
        },
        "flex_paper": {
            label: partial(_flex_paper, edit) for label, edit in FLEX_PAPER_ABLATIONS.items()
        },
    }
)
