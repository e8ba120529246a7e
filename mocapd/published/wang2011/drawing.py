"""The posed body drawn into a camera, on the grid of samples that the picture is classified on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import PosedJoints, camera_arrays, plain
from mocapd.body.model import BodyModel
from mocapd.body.posing_kernels import forward_kinematics, skin_and_project
from mocapd.body.skeleton import N_JOINTS
from mocapd.types import Bytes, Camera, Floats, Ints
from mocapd.vision.raster_kernels import rasterise


@dataclass(frozen=True, slots=True)
class Grid:
    """Samples at pixels x0 + stride i, y0 + stride j for i < width, j < height."""

    x0: int
    y0: int
    width: int
    height: int
    stride: int

    def to_pixels(self, samples: Floats) -> Floats:
        """Positions (...,2) on the grid as pixels."""
        pixels: Floats = samples * self.stride + np.array([self.x0, self.y0], dtype=float)
        return pixels

    def sampled(self, pixels: Bytes) -> Bytes:
        """The samples (height,width,3) of a whole frame."""
        below, right = self.y0 + self.stride * self.height, self.x0 + self.stride * self.width
        return pixels[self.y0 : below : self.stride, self.x0 : right : self.stride]


@dataclass(frozen=True, slots=True, eq=False)
class Posture:
    """A pose through forward kinematics: root_m (3,), local (J,4), R (J,3,3), joints_m (J,3), turned (J,4)."""

    root_m: Floats
    local_xyzw: Floats
    R: Floats
    joints_m: Floats
    turned_xyzw: Floats


@dataclass(frozen=True, slots=True, eq=False)
class PatchRenderer:
    """What a camera sees of a posture: the triangle at each sample (h,w), -1 for none; samples (T,) per
    triangle; by area the samples' count (A,) and mean position (A,2) on the grid."""

    triangle_at: NDArray[np.int32]
    samples: Ints
    count: Floats
    centroid: Floats


def posture(model: BodyModel, root_m: Floats, local_xyzw: Floats) -> Posture:
    """Forward kinematics of the mean body."""
    R, joints = np.empty((N_JOINTS, 3, 3)), np.empty((N_JOINTS, 3))
    turned = np.empty((N_JOINTS, 4))
    forward_kinematics(model.parents, model.rest_m, root_m, local_xyzw, R, joints, turned)
    return Posture(root_m, local_xyzw, R, joints, turned)


def posed_joints(model: BodyModel, body: Posture) -> PosedJoints:
    """A posture as the kernels take it."""
    return PosedJoints(model.rest_m, body.R, body.joints_m, body.turned_xyzw)


def project_body(
    model: BodyModel, body: Posture, camera: Camera, grid: Grid
) -> tuple[Floats, Floats]:
    """Vertices on the grid (V,2) and their depth (V,) [m]."""
    xy, depth = np.empty((len(model.vertices_m), 2)), np.empty(len(model.vertices_m))
    # the kernel averages blocks of pixels; here a sample is one pixel
    offset = np.array([grid.x0, grid.y0]) + 0.5 - 0.5 * grid.stride
    skin_and_project(
        model.vertices_m, plain(model.skin), plain(posed_joints(model, body)),
        plain(camera_arrays(camera)), offset,
        1.0 / grid.stride, xy, depth,
    )  # fmt: skip
    return xy, depth


def draw_vertices(
    model: BodyModel, xy: Floats, depth: Floats, height: int, width: int
) -> PatchRenderer:
    """Rasterise projected vertices."""
    triangle_at = np.empty((height, width), np.int32)
    rasterise(xy, depth, model.triangles, np.empty((height, width), np.float32), triangle_at)
    at = np.flatnonzero(triangle_at >= 0)  # flat, which is twice as fast
    y, x = np.divmod(at, width)
    seen = triangle_at.ravel()[at]
    samples = np.bincount(seen, minlength=len(model.triangles))
    return PatchRenderer(triangle_at, samples, *_patch_centroids(model.area[seen], x, y))


def classified_patches(
    ids: Bytes, nearest_yx: NDArray[np.int16], triangle_at: NDArray[np.int32], area: Bytes
) -> tuple[Floats, Floats]:
    """Count (A,) and mean x, y (A,2) of the classified samples (h,w) of each patch.

    Each colour is on two patches: a sample belongs to the one whose rendered sample of that colour is nearest, nearest_yx
    (10,h,w,2).
    """
    y, x = np.nonzero(ids)
    row, column = nearest_yx[ids[y, x] - 1, y, x].T
    near = row >= 0
    patch = area[triangle_at[row[near], column[near]]]
    return _patch_centroids(patch, x[near], y[near])


def _patch_centroids(patch: Bytes, x: Ints, y: Ints) -> tuple[Floats, Floats]:
    """Count (A,) and mean x, y (A,2) of samples (S,) in each patch, an `Area`; 0 without samples."""
    count = np.bincount(patch, minlength=N_AREAS).astype(float)
    sums = [np.bincount(patch, at, N_AREAS) for at in (x, y)]
    return count, np.stack(sums, axis=1) / np.maximum(count, 1.0)[:, None]


def draw(model: BodyModel, body: Posture, camera: Camera, grid: Grid) -> PatchRenderer:
    """The posture as the camera sees it."""
    return draw_vertices(model, *project_body(model, body, camera, grid), grid.height, grid.width)


def triangle_points(model: BodyModel) -> Floats:
    """T-pose centres (T,3) of the triangles [m]."""
    points: Floats = model.vertices_m[model.triangles].mean(axis=1)
    return points


def posed_points(model: BodyModel, body: Posture, points_m: Floats) -> Floats:
    """Triangle centres (T,3) of the posed body in the world [m]."""
    out = np.zeros_like(points_m)
    for b in range(model.triangle_bones.shape[1]):
        j = model.triangle_bones[:, b]
        moved = np.einsum("tik,tk->ti", body.R[j], points_m - model.rest_m[j]) + body.joints_m[j]
        out += model.triangle_weights[:, b, None] * moved
    return out
