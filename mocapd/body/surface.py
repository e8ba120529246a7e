"""A generic closed surface of the body that carries the shirt's twenty patches.

Torso, arms with hands, neck with head, and legs are closed tubes that overlap. Girths are means of
adults as fractions of stature (ANSUR II, 2012: breadths and depths of chest, waist and hips;
circumferences of biceps, forearm, wrist, thigh, calf), 0.004 added under cloth. The surface depends
linearly on the shape factors, so its derivatives are differences taken once.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.shape import N_FACTORS, BodyShape, mean_shape, skeleton_of
from mocapd.body.shirt import standard_shirt
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.types import Floats, Pose, Skeleton

SKIN, SHIRT, TROUSERS = 0, 1, 2
TORSO, LEFT_ARM, RIGHT_ARM, HEAD, LEGS = 0, 1, 2, 3, 4

_TORSO_COLUMNS = 24  # a multiple of 4, so that the patch borders run along edges
_ARM_COLUMNS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """T-pose vertices_m (V,3); triangles (T,3), counter-clockwise from outside; per triangle
    patch (T,) 0..20, material (T,) and part (T,); skin weights (V,J), rows summing to 1."""

    vertices_m: Floats
    triangles: NDArray[np.int32]
    patch: NDArray[np.uint8]
    material: NDArray[np.uint8]
    part: NDArray[np.uint8]
    weights: Floats


@dataclass(frozen=True, slots=True, eq=False)
class _Tube:
    rings_m: Floats  # (R, C, 3)
    weights: Floats  # (R, C, J)
    patch: NDArray[np.uint8]  # (R-1, C) of the band above ring r, column c..c+1
    material: NDArray[np.uint8]  # (R-1,)
    part: int


def build_surface(shape: BodyShape) -> Surface:
    """The dressed body of this shape in its T-pose."""
    skeleton = skeleton_of(shape)
    tubes = [
        _torso(shape, skeleton),
        _arm(shape, skeleton, "left"),
        _arm(shape, skeleton, "right"),
        _head(shape, skeleton),
        _leg(shape, skeleton, "left"),
        _leg(shape, skeleton, "right"),
    ]
    return _join(tubes)


def shape_derivatives(stature_m: float) -> tuple[Floats, Floats]:
    """d vertices / d factor (N_FACTORS,V,3) and d rest joints / d factor (N_FACTORS,J,3) at the mean shape [m]."""
    step = 0.02
    dv, dj = [], []
    for i in range(N_FACTORS):
        ends = []
        for sign in (-1.0, 1.0):
            factors = np.ones(N_FACTORS)
            factors[i] += sign * step
            shape = BodyShape(stature_m, factors)
            ends.append((build_surface(shape).vertices_m, skeleton_of(shape).rest_m))
        dv.append((ends[1][0] - ends[0][0]) / (2 * step))
        dj.append((ends[1][1] - ends[0][1]) / (2 * step))
    return np.array(dv), np.array(dj)


def mean_surface(stature_m: float) -> Surface:
    """The surface of the mean body of this stature."""
    return build_surface(mean_shape(stature_m))


def posed_vertices(surface: Surface, skeleton: Skeleton, pose: Pose, joints_m: Floats) -> Floats:
    """Linear blend skinning: vertices (V,3) in the world, joints_m being the posed joint centres."""
    R = rotations.to_matrix(pose.quats_xyzw)
    t = joints_m - np.einsum("jab,jb->ja", R, skeleton.rest_m)
    blended_R = np.einsum("vj,jab->vab", surface.weights, R)
    out: Floats = np.einsum("vab,vb->va", blended_R, surface.vertices_m) + surface.weights @ t
    return out


# --- torso -----------------------------------------------------------------------------------

# Per height: fraction of the way from hips (0) to neck joint (1), half width, extent in front of
# and behind the line hips-neck, exponent of the superellipse. Widths and depths in statures.
_TORSO_PROFILE = np.array([
    [-0.270, 0.088, 0.058, 0.070, 2.4],
    [-0.100, 0.098, 0.066, 0.076, 2.4],
    [0.000, 0.096, 0.068, 0.072, 2.4],
    [0.120, 0.089, 0.068, 0.062, 2.4],
    [0.250, 0.083, 0.066, 0.056, 2.4],
    [0.375, 0.083, 0.068, 0.056, 2.4],
    [0.500, 0.086, 0.073, 0.060, 2.5],
    [0.600, 0.090, 0.076, 0.065, 2.5],
    [0.680, 0.093, 0.073, 0.069, 2.5],
    [0.750, 0.097, 0.066, 0.068, 2.4],
    [0.820, 0.101, 0.056, 0.063, 2.3],
    [0.890, 0.094, 0.045, 0.055, 2.1],
    [0.945, 0.073, 0.036, 0.047, 2.0],
    [1.000, 0.045, 0.030, 0.038, 2.0],
])  # fmt: skip


def _torso(shape: BodyShape, skeleton: Skeleton) -> _Tube:
    _, shoulders, _, _, width, depth, _ = shape.factors
    hips, neck = skeleton.rest_m[INDEX["hips"]], skeleton.rest_m[INDEX["neck"]]
    profile = _TORSO_PROFILE
    f = profile[:, 0]
    centre = hips + f[:, None] * (neck - hips)
    # the half width follows the torso below and the shoulder girdle above
    girdle = np.clip((f - 0.55) / 0.3, 0.0, 1.0)
    a = profile[:, 1] * shape.stature_m * ((1 - girdle) * width + girdle * shoulders)
    front, back = (profile[:, i] * shape.stature_m * depth for i in (2, 3))
    angle = 2 * np.pi * np.arange(_TORSO_COLUMNS) / _TORSO_COLUMNS  # 0: left side, 90 deg: front
    c, s = np.cos(angle)[None], np.sin(angle)[None]
    power = 2.0 / profile[:, 4:5]
    x = a[:, None] * np.sign(c) * np.abs(c) ** power
    extent = np.where(s >= 0, front[:, None], back[:, None])
    z = np.where(np.abs(s) < 1e-9, 0.0, extent * np.sign(s) * np.abs(s) ** power)
    x = np.where(np.abs(c) < 1e-9, 0.0, x)
    rings = np.stack([x, np.broadcast_to(centre[:, 1:2], x.shape), z + centre[:, 2:3]], axis=-1)
    patch = np.zeros((len(f) - 1, _TORSO_COLUMNS), dtype=np.uint8)
    mid = 0.5 * (f[:-1] + f[1:])
    # quarter 0: front left, 1: front right
    column = np.arange(_TORSO_COLUMNS) * 4 // _TORSO_COLUMNS
    for r, height in enumerate(mid):
        if height > 0:
            upper = [1, 2, 6, 5] if height > 0.5 else [3, 4, 8, 7]
            patch[r] = np.array(upper)[column]
    material = np.where(mid > 0, SHIRT, TROUSERS).astype(np.uint8)
    return _Tube(rings, _torso_weights(rings, skeleton), patch, material, TORSO)


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


# --- arms ------------------------------------------------------------------------------------

# Along the bone: fraction of its length, radius in statures (cloth included on the sleeve).
_UPPER_ARM = np.array([[-0.18, 0.022], [-0.10, 0.034], [0.0, 0.0400], [0.16, 0.0405], [0.30, 0.0375],
                       [0.45, 0.0345], [0.62, 0.0325], [0.80, 0.0305], [0.92, 0.0295]])  # fmt: skip
_FOREARM = np.array([[0.0, 0.0290], [0.10, 0.0290], [0.25, 0.0287], [0.40, 0.0267], [0.55, 0.0240],
                     [0.75, 0.0205], [0.95, 0.0180]])  # fmt: skip
_HAND = np.array([[1.0, 0.0150], [1.15, 0.0190], [1.35, 0.0220], [1.55, 0.0190], [1.72, 0.0080]])


def _arm(shape: BodyShape, skeleton: Skeleton, side: str) -> _Tube:
    girth = shape.factors[6]
    arm, elbow, wrist = (
        skeleton.rest_m[INDEX[side + bone]] for bone in ("UpperArm", "LowerArm", "Hand")
    )
    hand_scale = np.linalg.norm(wrist - elbow) / shape.factors[3]  # hands do not follow the forearm
    centres, radii = [], []
    for t, r in _UPPER_ARM:
        centres.append(arm + t * (elbow - arm))
        radii.append(r * girth)
    for t, r in _FOREARM:
        centres.append(elbow + t * (wrist - elbow))
        radii.append(r * girth)
    direction = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    for t, r in _HAND:
        centres.append(wrist + (t - 1.0) * hand_scale * direction)
        radii.append(r)
    centre = np.array(centres)
    radius = np.array(radii) * shape.stature_m
    flat = np.ones(len(radius))
    flat[-len(_HAND) :] = [0.95, 0.7, 0.5, 0.45, 0.45]  # palms face down: thin in y
    outward = 1.0 if side == "left" else -1.0
    angle = 2 * np.pi * np.arange(_ARM_COLUMNS) / _ARM_COLUMNS * outward  # 0: up; front first
    ring = np.stack([np.zeros_like(angle), np.cos(angle), np.sin(angle) * outward], axis=-1)
    rings = centre[:, None] + radius[:, None, None] * ring[None] * np.stack(
        [np.ones_like(flat), flat, np.ones_like(flat)], -1
    )[:, None]  # fmt: skip
    n_upper, n_fore = len(_UPPER_ARM), len(_FOREARM)
    patch = np.zeros((len(radius) - 1, _ARM_COLUMNS), dtype=np.uint8)
    material = np.full(len(radius) - 1, SKIN, dtype=np.uint8)
    base = 9 if side == "left" else 15
    middle = angle + 0.5 * (angle[1] - angle[0])
    front = np.sin(middle) * outward > 0
    for r in range(n_upper + n_fore - 1):
        material[r] = SHIRT
        if r < n_upper:
            top = _UPPER_ARM[r + 1, 0] if r + 1 < n_upper else 1.0
            if 0.5 * (_UPPER_ARM[r, 0] + top) < standard_shirt().arm_fractions["shoulder"][1]:
                patch[r] = base
            else:
                patch[r] = np.where(front, base + 1, base + 2)
        else:
            mid = 0.5 * (_FOREARM[r - n_upper, 0] + _FOREARM[r - n_upper + 1, 0])
            if mid < standard_shirt().arm_fractions["forearm"][1]:
                patch[r] = np.where(front, base + 3, base + 4)
            else:
                patch[r] = base + 5
    weights = _arm_weights(centre, skeleton, side)
    return _Tube(
        rings,
        np.repeat(weights[:, None], _ARM_COLUMNS, axis=1),
        patch,
        material,
        LEFT_ARM if side == "left" else RIGHT_ARM,
    )


def _arm_weights(centre_m: Floats, skeleton: Skeleton, side: str) -> Floats:
    """Per ring: the upper arm takes over at the shoulder, the forearm at the elbow, the hand at the wrist."""
    x = np.abs(centre_m[:, 0])
    arm, elbow, wrist = (
        abs(skeleton.rest_m[INDEX[side + bone], 0]) for bone in ("UpperArm", "LowerArm", "Hand")
    )
    upper = elbow - arm
    arm_share = np.clip(0.5 + (x - arm) / (0.30 * upper), 0.0, 1.0)
    fore_share = np.clip(0.5 + (x - elbow) / (0.24 * upper), 0.0, 1.0)
    hand_share = np.clip(0.5 + (x - wrist) / (0.12 * upper), 0.0, 1.0)
    weights = np.zeros((len(x), N_JOINTS))
    weights[:, INDEX[side + "Shoulder"]] = 1 - arm_share
    weights[:, INDEX[side + "UpperArm"]] = arm_share * (1 - fore_share)
    weights[:, INDEX[side + "LowerArm"]] = fore_share * (1 - hand_share)
    weights[:, INDEX[side + "Hand"]] = hand_share
    return weights


# --- head and legs ---------------------------------------------------------------------------


def _head(shape: BodyShape, skeleton: Skeleton) -> _Tube:
    """Neck and an egg for the head: height from chin to crown 0.13, breadth 0.087, depth 0.112 statures."""
    h = shape.stature_m
    neck, head = skeleton.rest_m[INDEX["neck"]], skeleton.rest_m[INDEX["head"]]
    table = np.array([
        [-0.02, 0.036, 0.036, -0.004], [0.010, 0.033, 0.036, 0.0], [0.030, 0.034, 0.042, 0.008],
        [0.045, 0.038, 0.052, 0.012], [0.070, 0.043, 0.056, 0.012], [0.095, 0.0435, 0.056, 0.010],
        [0.118, 0.037, 0.048, 0.008], [0.135, 0.020, 0.026, 0.004],
    ])  # fmt: skip
    angle = 2 * np.pi * np.arange(_ARM_COLUMNS) / _ARM_COLUMNS
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
    patch, material = np.zeros((bands, _ARM_COLUMNS), np.uint8), np.full(bands, SKIN, np.uint8)
    return _Tube(rings, weights, patch, material, HEAD)


def _leg(shape: BodyShape, skeleton: Skeleton, side: str) -> _Tube:
    """Thigh and shank as one tube, a wedge for the foot."""
    h = shape.stature_m
    hip, knee, foot = (
        skeleton.rest_m[INDEX[side + bone]] for bone in ("UpperLeg", "LowerLeg", "Foot")
    )
    spans = [
        (foot - [0, 0.024 * h, 0], 0.020, 0.048, 0.030), (foot, 0.024, 0.030, 0.004),
        (foot + 0.35 * (knee - foot), 0.027, 0.028, -0.002),
        (foot + 0.70 * (knee - foot), 0.033, 0.035, -0.004), (knee, 0.034, 0.036, 0.004),
        (knee + 0.4 * (hip - knee), 0.042, 0.045, 0.006), (knee + 0.8 * (hip - knee), 0.050, 0.052, 0.003),
        (hip + [0, 0.02 * h, 0], 0.046, 0.050, 0.0),
    ]  # fmt: skip
    angle = 2 * np.pi * np.arange(_ARM_COLUMNS) / _ARM_COLUMNS
    rings, weights = [], []
    for point, rx, rz, dz in spans:
        ring = np.stack([rx * np.cos(angle), 0 * angle, rz * np.sin(angle) + dz], -1) * h
        rings.append(point + ring)
        w = np.zeros((_ARM_COLUMNS, N_JOINTS))
        thigh = np.clip(0.5 + (point[1] - knee[1]) / (0.06 * h), 0.0, 1.0)
        ankle = np.clip(0.5 - (point[1] - foot[1]) / (0.04 * h), 0.0, 1.0)
        w[:, INDEX[side + "UpperLeg"]] = thigh
        w[:, INDEX[side + "LowerLeg"]] = (1 - thigh) * (1 - ankle)
        w[:, INDEX[side + "Foot"]] = (1 - thigh) * ankle
        weights.append(w)
    bands = len(spans) - 1
    material = np.full(bands, TROUSERS, np.uint8)
    material[0] = SKIN
    patch = np.zeros((bands, _ARM_COLUMNS), np.uint8)
    return _Tube(np.array(rings), np.array(weights), patch, material, LEGS)


# --- joining ---------------------------------------------------------------------------------


def _join(tubes: list[_Tube]) -> Surface:
    vertices, triangles, patches, materials, parts, weights = [], [], [], [], [], []
    offset = 0
    for tube in tubes:
        R, C, _ = tube.rings_m.shape
        ends = [tube.rings_m[i].mean(0)[None] for i in (0, -1)]
        points = np.concatenate([tube.rings_m.reshape(-1, 3), *ends])
        flat_weights = tube.weights.reshape(R * C, -1)
        vertices.append(points)
        weights.append(np.concatenate([flat_weights, flat_weights[:1], flat_weights[-1:]]))
        columns = np.arange(C)
        after = (columns + 1) % C
        faces, face_patch, face_material = [], [], []
        for r in range(R - 1):
            a, b = r * C + columns, r * C + after
            c, d = (r + 1) * C + columns, (r + 1) * C + after
            faces += [np.stack([a, c, b], -1), np.stack([b, c, d], -1)]
            face_patch += [tube.patch[r], tube.patch[r]]
            face_material += [np.full(2 * C, tube.material[r])]
        faces.append(np.stack([np.full(C, R * C), columns, after], -1))
        faces.append(
            np.stack([np.full(C, R * C + 1), (R - 1) * C + after, (R - 1) * C + columns], -1)
        )
        face_patch += [tube.patch[0], tube.patch[-1]]
        face_material += [np.full(C, tube.material[0]), np.full(C, tube.material[-1])]
        triangle = np.concatenate(faces)
        triangles.append(_outward(points, triangle) + offset)
        patches.append(np.concatenate(face_patch))
        materials.append(np.concatenate(face_material))
        parts.append(np.full(len(triangle), tube.part))
        offset += len(points)
    w = np.concatenate(weights)
    return Surface(
        vertices_m=np.concatenate(vertices),
        triangles=np.concatenate(triangles).astype(np.int32),
        patch=np.concatenate(patches).astype(np.uint8),
        material=np.concatenate(materials).astype(np.uint8),
        part=np.concatenate(parts).astype(np.uint8),
        weights=w / w.sum(axis=1, keepdims=True),
    )


def _outward(points_m: Floats, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles, turned as one so that the enclosed volume is positive."""
    a, b, c = (points_m[triangles[:, i]] - points_m.mean(0) for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
    return triangles if volume > 0 else triangles[:, ::-1]
