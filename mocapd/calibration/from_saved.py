"""What a saved calibration knows."""

from pathlib import Path

import numpy as np

from mocapd.body.shape import FACTORS
from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.calibration.saved_calibration import SavedCalibration, SavedWearer
from mocapd.calibration.shirt_pictures import personal_model
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.types import LabelledPicture


def from_saved(tables: SavedCalibration, path: Path) -> Calibration:
    """With the pictures that it names, and without a rig where the cameras are not placed; `path`: its file.

    Raises InputError or ConfigError.
    """
    pictures = saved_pictures(tables, path)
    personal = tables.wearer is not None and tables.wearer.personal_colours
    W = {one.id: np.array(one.colour.W) for one in tables.camera if one.colour is not None}
    return Calibration(
        tables.rig(str(path)) if tables.is_placed else None,
        Wearer() if tables.wearer is None else _wearer(tables.wearer),
        ShirtColours(personal_model(pictures, W) if personal else (), pictures),
    )


def saved_pictures(tables: SavedCalibration, path: Path) -> dict[str, LabelledPicture]:
    """By camera the picture of the shirt with its strokes; `path`: the tables' file. Raises InputError or ConfigError."""
    colours = {one.id: one.colour for one in tables.camera if one.colour is not None}
    return {
        name: read_labelled(path.parent / one.picture, path.parent / one.strokes)
        for name, one in colours.items()
    }


def _wearer(told: SavedWearer) -> Wearer:
    if told.proportions is None:
        return Wearer(told.stature_m, has_shirt=told.has_shirt)
    factors = [told.proportions.get(name, 1.0) for name in FACTORS]
    return Wearer(told.stature_m, np.array(factors), told.has_shirt)
