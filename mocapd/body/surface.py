"""A closed surface of the body in areas: overlapping closed tubes, and its skinning."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.geometry import rotations
from mocapd.types import Floats, Pose, Skeleton

# materials: bare, and what clothes cover above and below the hips
SKIN, TOP, TROUSERS = 0, 1, 2
# parts; a body with rough legs has LEGS, the whole body one part for each leg
TORSO, LEFT_ARM, RIGHT_ARM, HEAD, LEGS, LEFT_LEG, RIGHT_LEG = 0, 1, 2, 3, 4, 5, 6

LIMB_COLUMNS = 12  # points around head and limbs


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """T-pose vertices_m (V,3); triangles (T,3), counter-clockwise from outside; per triangle
    `Area` (T,), material (T,) and part (T,); skin weights (V,J), rows summing to 1."""

    vertices_m: Floats
    triangles: NDArray[np.int32]
    area: NDArray[np.uint8]
    material: NDArray[np.uint8]
    part: NDArray[np.uint8]
    weights: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Tube:
    """A closed piece in the T-pose: R rings of C points from one end to the other, with skin weights."""

    rings_m: Floats  # (R, C, 3)
    weights: Floats  # (R, C, J)
    area: NDArray[np.uint8]  # (R-1, C) of the band above ring r, column c..c+1
    material: NDArray[np.uint8]  # (R-1,)
    part: int


def posed_vertices(surface: Surface, skeleton: Skeleton, pose: Pose, joints_m: Floats) -> Floats:
    """Linear blend skinning: vertices (V,3) in the world, joints_m being the posed joint centres."""
    R = rotations.to_matrix(pose.quats_xyzw)
    t = joints_m - np.einsum("jab,jb->ja", R, skeleton.rest_m)
    blended_R = np.einsum("vj,jab->vab", surface.weights, R)
    out: Floats = np.einsum("vab,vb->va", blended_R, surface.vertices_m) + surface.weights @ t
    return out


def tube_points(tube: Tube) -> Floats:
    """The vertices (R * C + 2, 3) [m] of a tube with flat ends: its rings, then the middles of both ends."""
    ends = [tube.rings_m[i].mean(0)[None] for i in (0, -1)]
    return np.concatenate([tube.rings_m.reshape(-1, 3), *ends])


def join_tubes(tubes: list[Tube]) -> Surface:
    """The tubes with flat ends as one surface."""
    vertices, triangles, areas, materials, parts, weights = [], [], [], [], [], []
    offset = 0
    for tube in tubes:
        R, C, _ = tube.rings_m.shape
        points = tube_points(tube)
        flat_weights = tube.weights.reshape(R * C, -1)
        vertices.append(points)
        weights.append(np.concatenate([flat_weights, flat_weights[:1], flat_weights[-1:]]))
        columns = np.arange(C)
        after = (columns + 1) % C
        band = C * np.arange(R - 1)[:, None]
        a, b, c, d = band + columns, band + after, band + C + columns, band + C + after
        first, last = np.full(C, R * C), np.full(C, R * C + 1)
        side = np.stack([a, c, b, b, c, d], -1).reshape(R - 1, C, 2, 3).swapaxes(1, 2)
        triangle = np.concatenate([
            side.reshape(-1, 3),
            np.stack([first, columns, after], -1),
            np.stack([last, (R - 1) * C + after, (R - 1) * C + columns], -1),
        ])  # fmt: skip
        triangles.append(_outward(points, triangle) + offset)
        around = np.repeat(tube.area, 2, axis=0)  # of a band's both triangles
        areas.append(np.concatenate([around.ravel(), tube.area[0], tube.area[-1]]))
        ends_material = np.repeat(tube.material[[0, -1]], C)
        materials.append(np.concatenate([np.repeat(tube.material, 2 * C), ends_material]))
        parts.append(np.full(len(triangle), tube.part))
        offset += len(points)
    w = np.concatenate(weights)
    return Surface(
        vertices_m=np.concatenate(vertices),
        triangles=np.concatenate(triangles).astype(np.int32),
        area=np.concatenate(areas).astype(np.uint8),
        material=np.concatenate(materials).astype(np.uint8),
        part=np.concatenate(parts).astype(np.uint8),
        weights=w / w.sum(axis=1, keepdims=True),
    )


def _outward(points_m: Floats, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles, turned as one so that the enclosed volume is positive."""
    a, b, c = (points_m[triangles[:, i]] - points_m.mean(0) for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
    return triangles if volume > 0 else triangles[:, ::-1]
