"""What a calibration tells a tracker: rig, wearer, light, and the colours of the wearer's own shirt."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mocapd.body.shape import FACTORS
from mocapd.calibration.saved_calibration import SavedCalibration
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.shirt.colour.white_balance import balanced
from mocapd.trackers.registry import TrackerInputs
from mocapd.types import Floats, LabelledPicture, Rig


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated:
    """pictures and W (3,3): by camera, of those whose colours are known; factors (N_FACTORS,) of the
    body; personal: whether the wearer's own colours replace the standard ones."""

    rig: Rig
    stature_m: float | None = None
    factors: Floats | None = None
    pictures: Mapping[str, LabelledPicture] = field(default_factory=dict)
    W: Mapping[str, Floats] = field(default_factory=dict)
    personal: bool = False


def read_calibrated(saved: SavedCalibration, path: Path) -> Calibrated:
    """The same of a saved calibration; `path`: its file. Raises InputError or ConfigError."""
    colours = {one.id: one.colour for one in saved.camera if one.colour is not None}
    wearer = saved.wearer
    factors = None
    if wearer is not None and wearer.proportions is not None:
        factors = np.array([wearer.proportions.get(name, 1.0) for name in FACTORS])
    return Calibrated(
        rig=saved.rig(str(path)),
        stature_m=None if wearer is None else wearer.stature_m,
        factors=factors,
        pictures={
            name: read_labelled(path.parent / one.picture, path.parent / one.strokes)
            for name, one in colours.items()
        },
        W={name: np.array(one.W) for name, one in colours.items()},
        personal=wearer is not None and wearer.personal_colours,
    )


def inputs_of_calibration(known: Calibrated, stature_m: float) -> TrackerInputs:
    """`stature_m` is for calibrations that do not say."""
    model: tuple[LabelledPicture, ...] = ()
    if known.personal:
        # each in the light of the model: a dye that differs stays as a difference, the light does not
        model = tuple(
            LabelledPicture(balanced(one.pixels, known.W[name]), one.labels)
            for name, one in known.pictures.items()
        )
    return TrackerInputs(
        rig=known.rig,
        stature_m=known.stature_m or stature_m,
        model=model,
        white_balance=known.pictures,
        factors=known.factors,
    )
