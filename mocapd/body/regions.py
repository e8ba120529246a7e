"""The whole body by what looks alike on it, whatever is worn: for trackers that learn appearance."""

from dataclasses import replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import BodyModel, sleeves_by_colour
from mocapd.body.pose_space import SIDES
from mocapd.body.shirt_patches import ShirtPatch
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import HEAD, LEFT_ARM, LEFT_LEG, RIGHT_ARM, RIGHT_LEG, TORSO

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
    HAIR = 7  # the head but for its face: which of them shows tells which way somebody looks


class Band(IntEnum):
    """Parts of the body that belong to one region or another by what is worn: how long shirt and sleeves are."""

    LOW_SLEEVE = 8  # of an upper arm, from the elbow: forearm or trunk
    HIGH_SLEEVE = 9
    LOW_HIPS = 10  # of the trunk, from below: legs or trunk
    HIGH_HIPS = 11
    WAIST = 12


class Label(IntEnum):
    """Where pixels are counted (`Fit.visible`, `matched`); sleeves keep the labels of the shirt's patches."""

    TRUNK = 1
    HEAD = 2
    LEFT_THIGH = 3
    LEFT_SHIN = 4  # and foot
    RIGHT_THIGH = 5
    RIGHT_SHIN = 6


def by_region(model: BodyModel) -> BodyModel:
    """A whole body in a shirt to the hips and with long sleeves, whose colours are its regions. Raises ValueError for a body
    without legs of its own."""
    worn = np.arange(1 + max(Band), dtype=np.uint8)
    worn[[Band.LOW_HIPS, Band.HIGH_HIPS]] = Region.LEG
    worn[[Band.WAIST, Band.LOW_SLEEVE, Band.HIGH_SLEEVE]] = Region.TRUNK
    return recoloured(model, worn[regions(model)])


def as_silhouette(model: BodyModel) -> BodyModel:
    """A whole body of one colour, as it is seen before its background. Raises ValueError as `by_region`."""
    return recoloured(model, np.ones(len(model.colour), np.uint8))


def regions(model: BodyModel) -> NDArray[np.uint8]:
    """The region (T,) of each triangle, or the band where clothes decide."""
    out = np.full(len(model.colour), Region.TRUNK, np.uint8)
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


def labels(model: BodyModel) -> NDArray[np.uint8]:
    """The label (T,) of each triangle: a `Label`, or a sleeve's patch; hands count as cuffs."""
    out = np.full(len(model.colour), Label.TRUNK, np.uint8)
    out[model.part == HEAD] = Label.HEAD
    main = model.triangle_bones[:, 0]
    for side, arm, leg, cuff, thigh, shin in (
        ("left", LEFT_ARM, LEFT_LEG, ShirtPatch.LEFT_CUFF, Label.LEFT_THIGH, Label.LEFT_SHIN),
        ("right", RIGHT_ARM, RIGHT_LEG, ShirtPatch.RIGHT_CUFF, Label.RIGHT_THIGH, Label.RIGHT_SHIN),
    ):
        sleeve = model.part == arm
        out[sleeve] = np.where(model.patch[sleeve] > 0, model.patch[sleeve], cuff)
        lower = np.isin(
            main,
            [INDEX[side + bone] for bone in ("LowerLeg", "Foot", "Toes") if side + bone in INDEX],
        )
        out[(model.part == leg) & ~lower] = thigh
        out[(model.part == leg) & lower] = shin
    return out


def recoloured(model: BodyModel, colour: NDArray[np.uint8]) -> BodyModel:
    """A whole body of these colours (T,), whose pixels are counted by `Label`. Raises ValueError as `by_region`."""
    if not model.space.whole:
        raise ValueError("a body of the upper pose space has no legs to be told apart")
    sleeves, start = sleeves_by_colour(model.part, colour)
    return replace(model, colour=colour, patch=labels(model), sleeves=sleeves, sleeve_start=start)
