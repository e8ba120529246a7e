"""Legs and feet as tubes, in trousers and shoes.

Girths are means of adults as fractions of stature (ANSUR II, 2012: circumferences of thigh 0.36 to 0.38,
calf 0.225 and ankle 0.13 statures; foot length 0.153, breadth 0.058), 0.003 to 0.006 added for cloth and
shoes. How far the flesh is in front of the bone is the mean of a man and a woman, see `trunk_tubes`: thighs lie in front of
the line from hip to knee, calves behind that from knee to ankle. Each ring of a leg moves with the bones that it is near to.
"""

import numpy as np

from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.body.surface import (
    LEFT_LEG,
    LEGS,
    LIMB_COLUMNS,
    RIGHT_LEG,
    SKIN,
    TROUSERS,
    Tube,
)
from mocapd.types import Floats, Skeleton

# Along the bone from its upper end: fraction of its length, half width, half depth, how far in front of
# the bone; in statures.
_THIGH = np.array([[-0.10, 0.052, 0.056, 0.004], [0.05, 0.060, 0.064, 0.006], [0.20, 0.061, 0.064, 0.011],
                   [0.40, 0.055, 0.059, 0.015], [0.60, 0.049, 0.053, 0.013], [0.80, 0.043, 0.046, 0.008],
                   [0.93, 0.041, 0.042, 0.004]])  # fmt: skip
_SHANK = np.array([[0.06, 0.039, 0.040, -0.005], [0.20, 0.039, 0.041, -0.014], [0.32, 0.038, 0.041, -0.015],
                   [0.50, 0.034, 0.037, -0.014], [0.70, 0.029, 0.031, -0.009], [0.88, 0.026, 0.028, -0.003],
                   [0.97, 0.025, 0.027, 0.000]])  # fmt: skip
# From heel to tip: how far in front of the ankle joint, half width, height of the upper side over the
# sole; in statures. The ankle joint is 0.0455 over the sole.
_FOOT = np.array([[-0.038, 0.012, 0.030], [-0.034, 0.020, 0.046], [-0.022, 0.024, 0.058], [-0.004, 0.026, 0.062],
                  [0.017, 0.026, 0.056], [0.042, 0.028, 0.045], [0.067, 0.031, 0.036], [0.085, 0.031, 0.030],
                  [0.105, 0.025, 0.024], [0.115, 0.014, 0.017]])  # fmt: skip
_ANKLE_HEIGHT = 0.0455


def leg_tube(shape: BodyShape, skeleton: Skeleton, side: str) -> Tube:
    """Thigh and shank of the whole body, from within the trunk to the ankle."""
    hip, knee, ankle = (
        skeleton.rest_m[INDEX[side + bone]] for bone in ("UpperLeg", "LowerLeg", "Foot")
    )
    girth = shape.factor("leg_girth")
    centre = np.concatenate([
        hip + _THIGH[:, :1] * (knee - hip), knee + _SHANK[:, :1] * (ankle - knee)
    ])  # fmt: skip
    table = np.concatenate([_THIGH, _SHANK])[:, 1:, None] * (shape.stature_m * girth)
    angle = 2 * np.pi * np.arange(LIMB_COLUMNS) / LIMB_COLUMNS
    rings = centre[:, None] + np.stack(
        [
            table[:, 0] * np.cos(angle),
            np.zeros((len(centre), LIMB_COLUMNS)),
            table[:, 1] * np.sin(angle) + table[:, 2],
        ],
        axis=-1,
    )
    bands = len(centre) - 1
    weights = _leg_weights(centre, skeleton, side)
    return Tube(
        rings,
        np.repeat(weights[:, None], LIMB_COLUMNS, axis=1),
        np.zeros((bands, LIMB_COLUMNS), np.uint8),
        np.full(bands, TROUSERS, np.uint8),
        _part(side),
    )


def foot_tube(shape: BodyShape, skeleton: Skeleton, side: str) -> Tube:
    """A shoe: flat on the floor in the T-pose, its tip moving with the toes."""
    h = shape.stature_m
    ankle, toes = skeleton.rest_m[INDEX[side + "Foot"]], skeleton.rest_m[INDEX[side + "Toes"]]
    # the middle line goes from the ankle towards the toes
    forwards = _FOOT[:, 0] * h
    x = ankle[0] + forwards * (toes[0] - ankle[0]) / (toes[2] - ankle[2])
    half = 0.5 * _FOOT[:, 2] * h
    y = ankle[1] - _ANKLE_HEIGHT * h + half
    angle = 2 * np.pi * np.arange(LIMB_COLUMNS) / LIMB_COLUMNS
    rings = np.stack(
        [
            x[:, None] + _FOOT[:, 1:2] * h * np.cos(angle),
            y[:, None] + half[:, None] * np.sin(angle),
            np.repeat((ankle[2] + forwards)[:, None], LIMB_COLUMNS, axis=1),
        ],
        axis=-1,
    )
    share = np.clip(0.5 + (forwards - (toes[2] - ankle[2])) / (0.03 * h), 0.0, 1.0)
    weights = np.zeros((len(_FOOT), N_JOINTS))
    weights[:, INDEX[side + "Toes"]] = share
    weights[:, INDEX[side + "Foot"]] = 1.0 - share
    bands = len(_FOOT) - 1
    return Tube(
        rings,
        np.repeat(weights[:, None], LIMB_COLUMNS, axis=1),
        np.zeros((bands, LIMB_COLUMNS), np.uint8),
        np.full(bands, SKIN, np.uint8),
        _part(side),
    )


def _part(side: str) -> int:
    return LEFT_LEG if side == "left" else RIGHT_LEG


def _leg_weights(centre_m: Floats, skeleton: Skeleton, side: str) -> Floats:
    """Per ring: the thigh takes over from the hips, the shank at the knee, the foot at the ankle."""
    hip, knee, ankle = (
        skeleton.rest_m[INDEX[side + bone], 1] for bone in ("UpperLeg", "LowerLeg", "Foot")
    )
    y, thigh = centre_m[:, 1], hip - knee
    leg = np.clip(0.7 + (hip - y) / (0.3 * thigh), 0.0, 1.0)
    below = np.clip(0.5 + (knee - y) / (0.24 * thigh), 0.0, 1.0)
    foot = np.clip(0.5 + (ankle - y) / (0.16 * thigh), 0.0, 1.0)
    weights = np.zeros((len(y), N_JOINTS))
    weights[:, INDEX["hips"]] = 1 - leg
    weights[:, INDEX[side + "UpperLeg"]] = leg * (1 - below)
    weights[:, INDEX[side + "LowerLeg"]] = below * (1 - foot)
    weights[:, INDEX[side + "Foot"]] = foot
    return weights


def plain_leg_tube(shape: BodyShape, skeleton: Skeleton, side: str) -> Tube:
    """Thigh and shank as one tube, a wedge for the foot: what the simulated person stands on."""
    h = shape.stature_m
    hip, knee, foot = (
        skeleton.rest_m[INDEX[side + bone]] for bone in ("UpperLeg", "LowerLeg", "Foot")
    )
    spans = [
        (foot - [0, 0.024 * h, 0], 0.020, 0.048, 0.030), (foot, 0.024, 0.030, 0.004),
        (foot + 0.35 * (knee - foot), 0.027, 0.028, -0.009),
        (foot + 0.70 * (knee - foot), 0.033, 0.035, -0.015), (knee, 0.034, 0.036, 0.000),
        (knee + 0.4 * (hip - knee), 0.042, 0.045, 0.013), (knee + 0.8 * (hip - knee), 0.050, 0.052, 0.010),
        (hip + [0, 0.02 * h, 0], 0.046, 0.050, 0.004),
    ]  # fmt: skip
    angle = 2 * np.pi * np.arange(LIMB_COLUMNS) / LIMB_COLUMNS
    rings, weights = [], []
    for point, rx, rz, dz in spans:
        ring = np.stack([rx * np.cos(angle), 0 * angle, rz * np.sin(angle) + dz], -1) * h
        rings.append(point + ring)
        w = np.zeros((LIMB_COLUMNS, N_JOINTS))
        thigh = np.clip(0.5 + (point[1] - knee[1]) / (0.06 * h), 0.0, 1.0)
        ankle = np.clip(0.5 - (point[1] - foot[1]) / (0.04 * h), 0.0, 1.0)
        w[:, INDEX[side + "UpperLeg"]] = thigh
        w[:, INDEX[side + "LowerLeg"]] = (1 - thigh) * (1 - ankle)
        w[:, INDEX[side + "Foot"]] = (1 - thigh) * ankle
        weights.append(w)
    bands = len(spans) - 1
    material = np.full(bands, TROUSERS, np.uint8)
    material[0] = SKIN
    area = np.zeros((bands, LIMB_COLUMNS), np.uint8)
    return Tube(np.array(rings), np.array(weights), area, material, LEGS)
