"""The whole body by what looks alike on it, whatever is worn: for trackers that learn appearance."""

from dataclasses import replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import BodyModel, sleeves_by_colour
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import HEAD, LEFT_ARM, LEFT_LEG, RIGHT_ARM, RIGHT_LEG

_FOOT = 0.05  # of the stature, in the T-pose: what is lower is shoe


class Region(IntEnum):
    """Ids of the body's regions. A forearm may be bare, so it is none of the trunk's; hands are its."""

    TRUNK = 1  # and upper arms
    HEAD = 2
    FOREARM = 3
    LEG = 4
    FOOT = 5


def by_region(model: BodyModel) -> BodyModel:
    """A whole body whose colours are its regions. Raises ValueError for a body without legs of its own."""
    return _coloured(model, regions(model))


def as_silhouette(model: BodyModel) -> BodyModel:
    """A whole body of one colour, as it is seen before its background. Raises ValueError as `by_region`."""
    return _coloured(model, np.ones(len(model.colour), np.uint8))


def regions(model: BodyModel) -> NDArray[np.uint8]:
    """The region (T,) of each triangle."""
    out = np.full(len(model.colour), Region.TRUNK, np.uint8)
    forearm = [INDEX[side + bone] for side in SIDES for bone in ("LowerArm", "Hand")]
    arms = (model.part == LEFT_ARM) | (model.part == RIGHT_ARM)
    legs = (model.part == LEFT_LEG) | (model.part == RIGHT_LEG)
    out[model.part == HEAD] = Region.HEAD
    out[arms & np.isin(model.triangle_bones[:, 0], forearm)] = Region.FOREARM
    out[legs] = Region.LEG
    out[legs & (model.centres_m[:, 1] < _FOOT * model.stature_m)] = Region.FOOT
    return out


def _coloured(model: BodyModel, colour: NDArray[np.uint8]) -> BodyModel:
    if not model.space.whole:
        raise ValueError("a body of the upper pose space has no legs to be told apart")
    sleeves, start = sleeves_by_colour(model.part, colour)
    return replace(model, colour=colour, sleeves=sleeves, sleeve_start=start)
