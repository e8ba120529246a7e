"""By what each tracker is measured: the method as published, and itself with one step disabled."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from lab.compared.ablations import CLOTHES_ABLATIONS, HECHT2009_ABLATIONS
from lab.compared.compare import BASELINE
from mocapd.calibration.calibration_record import Calibration
from mocapd.published.hecht2009.params import Params as Hecht2009Params
from mocapd.published.wang2011.params import paper_params
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.session.worker_thread import each_camera
from mocapd.trackers.registry import Resources, build
from mocapd.tracking.build import ProfileParams
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.tracker_inputs import wearer_shape


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """A tracker by its name, with its params."""

    tracker: str
    params: Any


def ready_rival(rival: Rival, resources: Resources, calibration: Calibration) -> ReadyTracker:
    """The rival and the wearer's shape for its first step. Raises ConfigError naming what it lacks."""
    own = replace(resources, params={rival.tracker: rival.params}, each=each_camera())
    return ReadyTracker(build(rival.tracker, calibration, own), wearer_shape(calibration))


# By tracker and label.
RIVALS: Mapping[str, Mapping[str, Rival]] = MappingProxyType(
    {
        "shirt": {
            "paper": Rival("wang2011", paper_params()),
            BASELINE: Rival("wang2011", paper_params(baseline=True)),
        },
        "markerless": {
            "paper": Rival("hecht2009", Hecht2009Params()),
            **{
                label: Rival("markerless", ProfileParams(clothes=edit(ClothesParams())))
                for label, edit in CLOTHES_ABLATIONS.items()
            },
        },
        "hecht2009": {
            label: Rival("hecht2009", edit(Hecht2009Params()))
            for label, edit in HECHT2009_ABLATIONS.items()
        },
    }
)
