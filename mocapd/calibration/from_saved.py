"""What a saved calibration knows."""

from pathlib import Path

import numpy as np

from mocapd.body.shape import FACTORS
from mocapd.calibration.record import Calibration, ShirtColours, Wearer
from mocapd.calibration.saved_calibration import SavedCalibration, SavedWearer
from mocapd.calibration.shirt_pictures import personal_model
from mocapd.shirt.colour.strokes import read_labelled


def from_saved(tables: SavedCalibration, path: Path) -> Calibration:
    """With the pictures that it names; `path`: its file. Raises InputError or ConfigError."""
    colours = {one.id: one.colour for one in tables.camera if one.colour is not None}
    pictures = {
        name: read_labelled(path.parent / one.picture, path.parent / one.strokes)
        for name, one in colours.items()
    }
    personal = tables.wearer is not None and tables.wearer.personal_colours
    W = {name: np.array(one.W) for name, one in colours.items()}
    return Calibration(
        tables.rig(str(path)),
        Wearer() if tables.wearer is None else _wearer(tables.wearer),
        ShirtColours(personal_model(pictures, W) if personal else (), pictures),
    )


def _wearer(told: SavedWearer) -> Wearer:
    if told.proportions is None:
        return Wearer(told.stature_m, has_shirt=told.has_shirt)
    factors = [told.proportions.get(name, 1.0) for name in FACTORS]
    return Wearer(told.stature_m, np.array(factors), told.has_shirt)
