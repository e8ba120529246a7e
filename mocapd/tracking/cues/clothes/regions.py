"""Any clothes as a garment: the regions of a whole body that look alike, whatever is worn."""

from collections.abc import Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import Area, on_arms
from mocapd.body.model import BodyModel
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import HEAD, LEFT_ARM, LEFT_LEG, RIGHT_ARM, RIGHT_LEG, TORSO
from mocapd.fit.surface_labels import SurfaceLabels, surface_labels

_BROW = 0.045  # of the stature below the crown: hair above
_FOOT = 0.05  # of the stature, in the T-pose: what is lower is shoe
# Along the trunk from the hips (0) to the neck joint (1), and along an upper arm from shoulder to elbow: where bands end
_HEM_ENDS = (-0.1, 0.0, 0.12)
_SLEEVE_ENDS = (0.4, 0.7)


class Region(IntEnum):
    """Ids of the body's regions. A forearm may be bare, so it is none of the trunk's; a hand is when the sleeve is long."""

    TRUNK = 1  # and upper arms
    FACE = 2
    FOREARM = 3
    LEG = 4
    FOOT = 5
    HAND = 6
    HAIR = 7  # the head without its face: which of the two is visible shows the facing direction


class Band(IntEnum):
    """Parts of the body that belong to one region or another by what is worn: how long top and sleeves are."""

    LOW_SLEEVE = 8  # of an upper arm, from the elbow: forearm or trunk
    HIGH_SLEEVE = 9
    LOW_HIPS = 10  # of the trunk, from below: legs or trunk
    HIGH_HIPS = 11
    WAIST = 12


def region_labels(model: BodyModel) -> SurfaceLabels:
    """Of a whole body with clothes to the hips and with long sleeves: its regions. Raises ValueError as `merged_labels`."""
    worn = np.arange(1 + max(Band), dtype=np.uint8)
    worn[[Band.LOW_HIPS, Band.HIGH_HIPS]] = Region.LEG
    worn[[Band.WAIST, Band.LOW_SLEEVE, Band.HIGH_SLEEVE]] = Region.TRUNK
    return merged_labels(model, worn)


def silhouette_labels(model: BodyModel) -> SurfaceLabels:
    """One label for the whole body. Raises ValueError as `merged_labels`."""
    return merged_labels(model, np.ones(1 + max(Band), np.uint8))


def merged_labels(model: BodyModel, worn: Sequence[int] | NDArray[np.uint8]) -> SurfaceLabels:
    """Of a whole body: that of each region or band, by its number. Raises ValueError for a body without legs of its own."""
    if not model.space.whole:
        raise ValueError("a body of the upper pose space has no legs")
    return surface_labels(np.asarray(worn, np.uint8)[regions(model)], _areas(model))


def regions(model: BodyModel) -> NDArray[np.uint8]:
    """The region (T,) of each triangle, or the band where clothes decide."""
    out = np.full(len(model.triangles), Region.TRUNK, np.uint8)
    forearm = [INDEX[side + bone] for side in SIDES for bone in ("LowerArm", "Hand")]
    arms = (model.part == LEFT_ARM) | (model.part == RIGHT_ARM)
    legs = (model.part == LEFT_LEG) | (model.part == RIGHT_LEG)
    head = model.part == HEAD
    forward, up = model.centres_m[:, 2], model.centres_m[:, 1]
    middle, crown = forward[head].mean(), up[head].max()
    out[head] = Region.HAIR
    out[head & (forward > middle) & (up < crown - _BROW * model.stature_m)] = Region.FACE
    out[arms & np.isin(model.triangle_bones[:, 0], forearm)] = Region.FOREARM
    hands = [INDEX[side + "Hand"] for side in SIDES]
    out[arms & np.isin(model.triangle_bones[:, 0], hands)] = Region.HAND
    out[legs] = Region.LEG
    out[legs & (model.centres_m[:, 1] < _FOOT * model.stature_m)] = Region.FOOT
    hips, neck = model.rest_m[INDEX["hips"], 1], model.rest_m[INDEX["neck"], 1]
    height = (up - hips) / (neck - hips)
    for band, end in zip(
        reversed((Band.LOW_HIPS, Band.HIGH_HIPS, Band.WAIST)), reversed(_HEM_ENDS), strict=True
    ):
        out[(model.part == TORSO) & (height < end)] = band
    for side, arm in (("left", LEFT_ARM), ("right", RIGHT_ARM)):
        shoulder, elbow = (model.rest_m[INDEX[side + bone]] for bone in ("UpperArm", "LowerArm"))
        along = (model.centres_m - shoulder) @ (elbow - shoulder) / np.sum((elbow - shoulder) ** 2)
        upper = (model.part == arm) & (out == Region.TRUNK)
        for band, start in zip((Band.HIGH_SLEEVE, Band.LOW_SLEEVE), _SLEEVE_ENDS, strict=True):
            out[upper & (along > start)] = band
    return out


def _areas(model: BodyModel) -> NDArray[np.uint8]:
    """The `Area` (T,) of each triangle of a whole body, with an undivided trunk; hands count as wrists."""
    out = np.full(len(model.triangles), Area.TORSO, np.uint8)
    out[model.part == HEAD] = Area.HEAD
    main = model.triangle_bones[:, 0]
    for side, arm, leg, wrist, thigh, shin in (
        ("left", LEFT_ARM, LEFT_LEG, Area.LEFT_WRIST, Area.LEFT_THIGH, Area.LEFT_SHIN),
        ("right", RIGHT_ARM, RIGHT_LEG, Area.RIGHT_WRIST, Area.RIGHT_THIGH, Area.RIGHT_SHIN),
    ):
        on_arm = model.part == arm
        sleeve = on_arm & on_arms(model.area)
        out[sleeve] = model.area[sleeve]
        out[on_arm & (model.area == Area.NONE)] = wrist
        lower = np.isin(
            main,
            [INDEX[side + bone] for bone in ("LowerLeg", "Foot", "Toes") if side + bone in INDEX],
        )
        out[(model.part == leg) & ~lower] = thigh
        out[(model.part == leg) & lower] = shin
    return out
