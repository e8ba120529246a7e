"""The dressed person as a fine mesh: rounded, with folds in the cloth, and a colour per triangle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.body.surface import HEAD, LEFT_LEG, LEGS, RIGHT_LEG, TOP, TROUSERS, Surface
from mocapd.body.surface_building import build_surface, build_whole_surface
from mocapd.geometry import rotations
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.sim.colour import linear_from_srgb
from mocapd.sim.person.dress_kernels import REACH, Dress, jacket_share
from mocapd.sim.person.dressing import dress_of, jacket_height
from mocapd.sim.person.figure_kernels import skin_vertices
from mocapd.sim.person.subdivision import FineSurface, subdivide
from mocapd.sim.person_spec import Clothes
from mocapd.types import Floats, Pose, Skeleton

_BONES = 4  # largest skin weights per vertex


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """vertices_m (V,3) in the T-pose, bones and weights (V,4), triangles (T,3), patch (T,) 0..20,
    albedo (T,3) linear RGB; folds_m (V,) more displacement along rest_normals (V,3) per radian of
    the bend of the joint `fold_joint` (V,), -1: none. jacket_m (V,): how far a jacket stands off, jacket_over
    (N,) the vertices that it may cover. `coarse`: the body without folds, for truth."""

    skeleton: Skeleton
    vertices_m: Floats
    rest_normals: Floats
    bones: NDArray[np.int32]
    weights: Floats
    triangles: NDArray[np.int32]
    patch: NDArray[np.uint8]
    albedo: Floats
    folds_m: Floats
    fold_joint: NDArray[np.int64]
    dress: Dress
    jacket_m: Floats
    jacket_over: NDArray[np.int32]
    coarse: Surface


def build_figure(shape: BodyShape, clothes: Clothes, seed: int, *, whole: bool = False) -> Figure:
    """The person of this shape in these clothes; folds and dyes follow from the seed. whole: with shaped legs,
    feet and a face."""
    coarse = build_whole_surface(shape) if whole else build_surface(shape)
    skeleton = skeleton_of(shape)
    fine = subdivide(coarse)
    rng = np.random.default_rng([seed, 3])
    cloth = np.zeros(len(fine.vertices_m))
    cloth[np.unique(fine.triangles[fine.material == TOP])] = 1.0
    trousers = np.unique(fine.triangles[fine.material == TROUSERS])
    cloth[trousers] = np.maximum(cloth[trousers], 0.6)
    height = clothes.wrinkles_m * cloth * _folds(fine.vertices_m, rng)
    height += _face(fine, skeleton, shape.stature_m)
    if whole:
        height += _head(fine, skeleton, shape.stature_m * shape.factor("head_size"))
    vertices = fine.vertices_m + height[:, None] * fine.normals
    joint, folds = _elbow_folds(fine.vertices_m, skeleton, cloth * clothes.wrinkles_m, rng)
    order = np.argsort(-fine.weights, axis=1)[:, :_BONES]
    weights = np.take_along_axis(fine.weights, order, axis=1)
    albedo = _albedo(fine, skeleton, clothes, shape.stature_m, rng)
    if whole:
        _knee_folds(joint, folds, fine.vertices_m, skeleton, cloth * clothes.wrinkles_m, rng)
    dress = dress_of(fine, skeleton, clothes, shape, face=whole)
    jacket_m, jacket_over = jacket_height(fine, dress, clothes, rng)
    patched = clothes.shirt == "standard-v1"
    return Figure(
        skeleton=skeleton,
        vertices_m=vertices,
        rest_normals=fine.normals,
        bones=order.astype(np.int32),
        weights=weights / weights.sum(axis=1, keepdims=True),
        triangles=fine.triangles,
        patch=fine.patch if patched else np.zeros_like(fine.patch),
        albedo=albedo,
        folds_m=folds,
        fold_joint=joint,
        dress=dress,
        jacket_m=jacket_m,
        jacket_over=jacket_over,
        coarse=coarse,
    )


def posed_figure(figure: Figure, pose: Pose, jacket: float = 0.0) -> Floats:
    """Vertices (V,3) in the world [m]; folds at a joint deepen as it bends. jacket: how far it is on, 0..1."""
    vertices = figure.vertices_m
    if jacket > 0.0 and len(figure.jacket_over):
        vertices = vertices.copy()
        over = figure.jacket_over
        share = jacket_share(figure.dress.rest_m[over, 0], figure.dress.outfits[0, REACH], jacket)
        vertices[over] += (share * figure.jacket_m[over])[:, None] * figure.rest_normals[over]
    parents = figure.skeleton.parents
    cosine = np.abs((pose.quats_xyzw * pose.quats_xyzw[parents]).sum(axis=1))
    bend = 2.0 * np.arccos(np.minimum(cosine, 1.0))
    R = rotations.to_matrix(pose.quats_xyzw)
    joints = joint_positions(figure.skeleton, pose)
    t = joints - np.einsum("jab,jb->ja", R, figure.skeleton.rest_m)
    out = np.empty_like(vertices)
    skin_vertices(
        vertices, figure.rest_normals, figure.folds_m, figure.fold_joint, bend,
        figure.bones, figure.weights, R, t, out,
    )  # fmt: skip
    return out


def _folds(points_m: Floats, rng: np.random.Generator) -> Floats:
    """A field of about -1..1 with ridges 8 to 18 cm apart, no two alike."""
    out = np.zeros(len(points_m))
    for _ in range(5):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        warp = 0.03 * np.sin(points_m @ rng.normal(scale=14.0, size=3) + rng.uniform(0, 6.3))
        wave = 2 * np.pi / rng.uniform(0.08, 0.18)
        out += np.sin(wave * (points_m @ direction + warp) + rng.uniform(0, 6.3))
    return out / 2.2


def _elbow_folds(
    points_m: Floats, skeleton: Skeleton, cloth_m: Floats, rng: np.random.Generator
) -> tuple[NDArray[np.int64], Floats]:
    """Which elbow's bend folds each vertex (V,), -1: none, and how far (V,) [m/rad]."""
    joint = np.full(len(points_m), -1, dtype=np.int64)
    depth = np.zeros(len(points_m))
    for side in ("left", "right"):
        elbow = INDEX[side + "LowerArm"]
        away = points_m - skeleton.rest_m[elbow]
        near = np.abs(away[:, 0]) < 0.16
        near &= np.hypot(away[:, 1], away[:, 2]) < 0.12
        joint[near] = elbow
        ripple = np.sin(2 * np.pi * away[:, 0] / 0.045 + rng.uniform(0, 6.3))
        depth[near] = (cloth_m * 0.7 * ripple * np.exp(-((away[:, 0] / 0.08) ** 2)))[near]
    return joint, depth


def _knee_folds(
    joint: NDArray[np.int64], depth: Floats, points_m: Floats, skeleton: Skeleton, cloth_m: Floats,
    rng: np.random.Generator,
) -> None:  # fmt: skip
    """The same at the knees, into joint (V,) and depth (V,)."""
    for side in ("left", "right"):
        knee = INDEX[side + "LowerLeg"]
        away = points_m - skeleton.rest_m[knee]
        near = (np.abs(away[:, 1]) < 0.18) & (np.hypot(away[:, 0], away[:, 2]) < 0.12)
        joint[near] = knee
        ripple = np.sin(2 * np.pi * away[:, 1] / 0.07 + rng.uniform(0, 6.3))
        depth[near] = (cloth_m * 0.7 * ripple * np.exp(-((away[:, 1] / 0.10) ** 2)))[near]


def _face(fine: FineSurface, skeleton: Skeleton, stature_m: float) -> Floats:
    """A nose, so that the head shows where it looks: displacement (V,) [m]."""
    at = skeleton.rest_m[INDEX["neck"]] + stature_m * np.array([0.0, 0.068, 0.066])
    square = (((fine.vertices_m - at) / (stature_m * np.array([0.011, 0.014, 0.02]))) ** 2).sum(1)
    nose: Floats = 0.012 * stature_m * np.exp(-square)
    return nose


def _head(fine: FineSurface, skeleton: Skeleton, size_m: float) -> Floats:
    """Hair, chin, throat and the sockets of the eyes: displacement (V,) [m]."""
    u, v, w = ((fine.vertices_m - skeleton.rest_m[INDEX["neck"]]) / size_m).T
    out = np.zeros(len(u))
    out += 0.006 * np.exp(-((u / 0.014) ** 2) - ((v - 0.031) / 0.008) ** 2) * (w > 0.03)
    out -= 0.009 * np.exp(-(((v - 0.012) / 0.011) ** 2)) * np.clip((w + 0.01) / 0.04, 0.0, 1.0)
    out -= (
        0.004
        * np.exp(-(((np.abs(u) - 0.0175) / 0.011) ** 2) - ((v - 0.086) / 0.009) ** 2)
        * (w > 0.03)
    )
    hair = np.clip(
        (v - 0.112 - np.where(w < 0.02, 0.8, 0.1) * np.minimum(w - 0.02, 0.0)) / 0.012, 0.0, 1.0
    )
    out += np.where(w < 0.02, 0.0055 * np.clip((v - 0.04) / 0.02, 0.0, 1.0), 0.0065 * hair)
    head = np.zeros(len(u), dtype=bool)
    head[np.unique(fine.triangles[fine.part == HEAD])] = True
    relief: Floats = np.where(head, out * size_m, 0.0)
    return relief


def _albedo(
    fine: FineSurface,
    skeleton: Skeleton,
    clothes: Clothes,
    stature_m: float,
    rng: np.random.Generator,
) -> Floats:
    """Linear RGB (T,3): dyes of the shirt's standard, a little off, and the other clothes."""
    shirt = standard_shirt()
    dyes = np.concatenate([[np.zeros(3)], linear_from_srgb(shirt.srgb)])
    dyes *= 1.0 + clothes.dye_variation * rng.normal(size=dyes.shape)
    skin = linear_from_srgb(clothes.skin_srgb)
    out = np.tile(skin, (len(fine.triangles), 1))
    out[fine.material == TROUSERS] = linear_from_srgb(clothes.trousers_srgb)
    legs = np.isin(fine.part, (LEGS, LEFT_LEG, RIGHT_LEG))
    out[legs & (fine.material != TROUSERS)] = linear_from_srgb(clothes.shoes_srgb)
    on_shirt = fine.patch > 0
    out[on_shirt] = dyes[shirt.colour_of_patch[fine.patch[on_shirt]]]
    centre = (fine.vertices_m[fine.triangles].mean(1) - skeleton.rest_m[INDEX["neck"]]) / stature_m
    hair = (centre[:, 1] > 0.112 - 0.45 * np.minimum(centre[:, 2], 0.0)) | (
        (centre[:, 1] > 0.052) & (centre[:, 2] < -0.005)
    )
    hair |= (centre[:, 1] > 0.108) & (centre[:, 2] < 0.062)
    out[(fine.part == HEAD) & hair] = linear_from_srgb(clothes.hair_srgb)
    return np.clip(out, 0.01, 0.95)
