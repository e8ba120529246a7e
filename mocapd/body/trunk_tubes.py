"""Trunk and head as tubes. Breadths and depths are means of adults as fractions of stature (ANSUR II).

How far the flesh is in front of the joints is the mean of an average man and an average woman of MakeHuman's body, whose
joints are where character rigs turn (MPFB2: base mesh, macro targets, default rig; CC0). Belly and chest lie
some 2 % of the stature in front of the line from hips to neck, and the head as much in front of the neck.
"""

import numpy as np

from mocapd.body.areas import Area
from mocapd.body.shape import N_FACTORS, BodyShape
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.body.surface import HEAD, LIMB_COLUMNS, SKIN, TOP, TORSO, TROUSERS, Tube
from mocapd.types import Floats, Skeleton

_TORSO_COLUMNS = 24  # a multiple of 4, so that the borders of areas run along edges
# areas around the trunk, front left first
_UPPER_QUARTERS = (
    Area.TORSO_FRONT_UPPER_LEFT,
    Area.TORSO_FRONT_UPPER_RIGHT,
    Area.TORSO_BACK_UPPER_RIGHT,
    Area.TORSO_BACK_UPPER_LEFT,
)
_LOWER_QUARTERS = (
    Area.TORSO_FRONT_LOWER_LEFT,
    Area.TORSO_FRONT_LOWER_RIGHT,
    Area.TORSO_BACK_LOWER_RIGHT,
    Area.TORSO_BACK_LOWER_LEFT,
)
# Per height: fraction of the way from hips (0) to neck joint (1), half width, half depth, how far its middle is in front of
# the line hips-neck, exponent of the superellipse. In statures.
_TORSO_PROFILE = np.array([
    [-0.270, 0.088, 0.0640, 0.003, 2.4],
    [-0.100, 0.098, 0.0710, -0.002, 2.4],
    [0.000, 0.096, 0.0700, 0.007, 2.4],
    [0.120, 0.089, 0.0650, 0.017, 2.4],
    [0.250, 0.083, 0.0610, 0.021, 2.4],
    [0.375, 0.083, 0.0620, 0.022, 2.4],
    [0.500, 0.086, 0.0665, 0.022, 2.5],
    [0.600, 0.090, 0.0705, 0.019, 2.5],
    [0.680, 0.093, 0.0710, 0.0135, 2.5],
    [0.750, 0.097, 0.0670, 0.007, 2.4],
    [0.820, 0.101, 0.0595, 0.003, 2.3],
    [0.890, 0.094, 0.0500, 0.001, 2.1],
    [0.945, 0.073, 0.0415, 0.004, 2.0],
    [1.000, 0.045, 0.0340, 0.000, 2.0],
])  # fmt: skip


def torso_tube(shape: BodyShape, skeleton: Skeleton) -> Tube:
    """From the upper thighs to the neck, its areas in quarters."""
    _, shoulders, _, _, width, depth, _ = shape.factors[:N_FACTORS]
    hips, neck = skeleton.rest_m[INDEX["hips"]], skeleton.rest_m[INDEX["neck"]]
    profile = _TORSO_PROFILE
    f = profile[:, 0]
    centre = hips + f[:, None] * (neck - hips)
    # the half width follows the torso below and the shoulder girdle above
    girdle = np.clip((f - 0.55) / 0.3, 0.0, 1.0)
    a = profile[:, 1] * shape.stature_m * ((1 - girdle) * width + girdle * shoulders)
    half_depth, middle = (profile[:, i : i + 1] * shape.stature_m for i in (2, 3))
    power = 2.0 / profile[:, 4:5]
    # 0: left side, 90 deg: front. Half of the columns lie in front of the line hips-neck, where the shirt's front ends,
    # and not in front of the middle
    behind = np.arcsin(np.sign(middle) * (np.abs(middle) / half_depth) ** (1.0 / power))
    half_round = np.arange(_TORSO_COLUMNS) * 2 / _TORSO_COLUMNS
    angle = np.where(
        half_round <= 1.0,
        -behind + half_round * (np.pi + 2 * behind),
        np.pi + behind + (half_round - 1.0) * (np.pi - 2 * behind),
    )
    c, s = np.cos(angle), np.sin(angle)
    c = np.where(np.abs(c) < 1e-9, 0.0, c)
    x = a[:, None] * np.sign(c) * np.abs(c) ** power
    z = half_depth * depth * np.sign(s) * np.abs(s) ** power + middle
    z = np.where(np.isin(half_round, (0.0, 1.0)), 0.0, z)
    rings = np.stack([x, np.broadcast_to(centre[:, 1:2], x.shape), z + centre[:, 2:3]], axis=-1)
    area = np.zeros((len(f) - 1, _TORSO_COLUMNS), dtype=np.uint8)
    mid = 0.5 * (f[:-1] + f[1:])
    column = np.arange(_TORSO_COLUMNS) * 4 // _TORSO_COLUMNS
    for r, height in enumerate(mid):
        if height > 0:
            quarters = _UPPER_QUARTERS if height > 0.5 else _LOWER_QUARTERS
            area[r] = np.array(quarters)[column]
    material = np.where(mid > 0, TOP, TROUSERS).astype(np.uint8)
    return Tube(rings, _torso_weights(rings, skeleton), area, material, TORSO)


def _torso_weights(points_m: Floats, skeleton: Skeleton) -> Floats:
    """Blend along the spine; near the shoulders, over to the collar bones and upper arms."""
    rest = skeleton.rest_m
    y, x = points_m[..., 1], points_m[..., 0]
    spine = ["hips", "spine", "chest", "upperChest"]
    level = np.array([rest[INDEX[name], 1] for name in spine])
    weights = np.zeros((*y.shape, N_JOINTS))
    # bone b rules from its own joint to the next one; blends are centred on the joints
    knots = np.array(
        [level[0], 0.5 * (level[1] + level[2]), 0.5 * (level[2] + level[3]), level[3] + 0.03]
    )
    for b, name in enumerate(spine):
        values = np.zeros(4)
        values[b] = 1.0
        weights[..., INDEX[name]] = np.interp(y, knots, values)
    shoulder = rest[INDEX["leftUpperArm"]]
    reach = np.clip((np.abs(x) / shoulder[0] - 0.35) / 0.5, 0.0, 1.0)
    high = np.clip(
        (y - (shoulder[1] - 0.05 * shoulder[1] / 0.8)) / (0.05 * shoulder[1] / 0.8), 0.0, 1.0
    )
    collar = 0.8 * reach * high
    for side, sign in (("left", 1.0), ("right", -1.0)):
        share = np.where(sign * x > 0, collar, 0.0)
        weights *= (1.0 - share)[..., None]
        weights[..., INDEX[side + "Shoulder"]] += share
    return weights


def head_tube(shape: BodyShape, skeleton: Skeleton) -> Tube:
    """Neck and an egg for the head: height from chin to crown 0.13, breadth 0.087, depth 0.112 statures."""
    h = shape.stature_m * shape.factor("head_size")
    neck, head = skeleton.rest_m[INDEX["neck"]], skeleton.rest_m[INDEX["head"]]
    table = np.array([
        [-0.02, 0.036, 0.036, 0.008], [0.010, 0.033, 0.036, 0.014], [0.030, 0.034, 0.044, 0.022],
        [0.045, 0.038, 0.052, 0.028], [0.070, 0.043, 0.056, 0.028], [0.095, 0.0435, 0.056, 0.025],
        [0.118, 0.037, 0.048, 0.022], [0.135, 0.020, 0.026, 0.018],
    ])  # fmt: skip
    angle = 2 * np.pi * np.arange(LIMB_COLUMNS) / LIMB_COLUMNS
    y = neck[1] + table[:, 0] * h
    x = table[:, 1:2] * h * np.cos(angle)
    z = neck[2] + table[:, 3:4] * h + table[:, 2:3] * h * np.sin(angle)
    rings = np.stack([x, np.broadcast_to(y[:, None], x.shape), z], axis=-1)
    weights = np.zeros((*x.shape, N_JOINTS))
    up = np.clip((y - neck[1]) / max(head[1] - neck[1], 1e-6), 0.0, 1.0)
    low = np.clip((neck[1] - y) / (0.02 * h), 0.0, 1.0)
    weights[..., INDEX["head"]] = up[:, None]
    weights[..., INDEX["neck"]] = ((1 - up) * (1 - low))[:, None]
    weights[..., INDEX["upperChest"]] = ((1 - up) * low)[:, None]
    bands = len(table) - 1
    area, material = np.zeros((bands, LIMB_COLUMNS), np.uint8), np.full(bands, SKIN, np.uint8)
    return Tube(rings, weights, area, material, HEAD)
