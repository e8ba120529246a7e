"""By what each tracker is measured: the method as published, and itself with one step disabled."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from lab.compared.ablations import FLEX_ABLATIONS, FLEX_PAPER_ABLATIONS
from lab.compared.compare import BASELINE
from mocapd.calibration.calibration_record import Calibration
from mocapd.session.side_by_side import each_camera
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.trackers.colour_paper.params import published
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex_paper.params import Params as PaperParams
from mocapd.trackers.known import known_shape
from mocapd.trackers.registry import Resources, build


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """A tracker by its name, with its params."""

    tracker: str
    params: Any


def ready_rival(rival: Rival, resources: Resources, calibration: Calibration) -> ReadyTracker:
    """The rival and the wearer's shape for its first step. Raises ConfigError naming what it lacks."""
    own = replace(resources, params={rival.tracker: rival.params}, each=each_camera())
    return ReadyTracker(build(rival.tracker, calibration, own), known_shape(calibration))


# By tracker and label.
RIVALS: Mapping[str, Mapping[str, Rival]] = MappingProxyType(
    {
        "colour": {
            "paper": Rival("colour_paper", published()),
            BASELINE: Rival("colour_paper", published(baseline=True)),
        },
        "flex": {
            "paper": Rival("flex_paper", PaperParams()),
            **{label: Rival("flex", edit(Params())) for label, edit in FLEX_ABLATIONS.items()},
        },
        "flex_paper": {
            label: Rival("flex_paper", edit(PaperParams()))
            for label, edit in FLEX_PAPER_ABLATIONS.items()
        },
    }
)
