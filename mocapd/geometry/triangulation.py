"""Points in space from their directions in several calibrated cameras."""

from collections.abc import Sequence

import numpy as np

from mocapd.geometry.camera_model import centre
from mocapd.types import Camera, Floats

_PARALLEL = 1e-9  # least ratio of the extreme singular values: rays closer to parallel meet nowhere


def triangulate(
    cameras: Sequence[Camera], xy: Floats, weights: Floats | None = None, rounds: int = 3
) -> tuple[Floats, Floats]:
    """Points (...,3) [m, world] and residuals (N,...) [m] from undistorted normalised rays (N,...,2).

    `xy` as `cameras.normalised` gives it. `weights` (N,...) are the inverse variances of xy, any
    scale; 0 or NaN coordinates: this camera does not see this point. The residual is the distance
    of the point from each ray, NaN where there is none. A point is NaN with fewer than two rays, or
    with parallel ones; it may lie behind a camera, so callers must check its depth.

    Linear DLT in inhomogeneous form, x r3.X - r1.X = t1 - x t3 (Hartley and Zisserman, Multiple
    View Geometry, section 12.2). Its algebraic error is the image error times the depth, so `rounds`
    - 1 times it is solved again with the rows divided by the depths found (Hartley and Sturm,
    Triangulation, CVIU 1997, section 4.2, Iterative-LS).
    """
    R = np.stack([camera.R for camera in cameras])
    t = np.stack([camera.t_m for camera in cameras])
    visible = np.asarray(np.isfinite(xy).all(axis=-1))
    if weights is not None:
        visible = visible & np.isfinite(weights) & (weights > 0.0)
    xy = np.where(visible[..., None], xy, 0.0)
    w = np.where(visible, 1.0 if weights is None else weights, 0.0)
    # one leading axis for cameras, one for all points
    shape = xy.shape[1:-1]
    xy, w = xy.reshape(len(cameras), -1, 2), w.reshape(len(cameras), -1)
    rows = xy[..., None] * R[:, None, 2:, :] - R[:, None, :2, :]  # (N, points, 2, 3)
    right = t[:, None, :2] - xy * t[:, None, 2:]  # (N, points, 2)
    points_m = _solve(rows, right, np.sqrt(w))
    for _ in range(rounds - 1):
        depth_m = points_m @ R[:, 2].T + t[:, 2]  # (points, N)
        # the sign does not matter; a depth near 0 must not take the whole weight
        scale = np.sqrt(w) / np.maximum(np.abs(depth_m.T), 1e-3)
        points_m = _solve(rows, right, scale)
    visible = visible.reshape(len(cameras), -1)
    residuals_m = np.where(visible, _distances(cameras, xy, points_m), np.nan)
    return points_m.reshape(*shape, 3), residuals_m.reshape(len(cameras), *shape)


def _solve(rows: Floats, right: Floats, scale: Floats) -> Floats:
    """Least squares of all points at once: rows (N,P,2,3), right (N,P,2), scale (N,P) to (P,3)."""
    n_cameras, n_points = scale.shape
    if n_cameras < 2:
        return np.full((n_points, 3), np.nan)
    scale = np.where(np.isfinite(scale), scale, 0.0)
    A = np.moveaxis(rows * scale[..., None, None], 1, 0).reshape(n_points, -1, 3)
    b = np.moveaxis(right * scale[..., None], 1, 0).reshape(n_points, -1)
    U, s, Vt = np.linalg.svd(A, full_matrices=False)
    solvable = (np.count_nonzero(scale, axis=0) >= 2) & (s[:, 2] > _PARALLEL * s[:, 0])
    s = np.where(solvable[:, None], s, np.nan)
    along = np.einsum("pik,pi->pk", U, b) / s
    points_m: Floats = np.einsum("pkj,pk->pj", Vt, along)
    return points_m


def _distances(cameras: Sequence[Camera], xy: Floats, points_m: Floats) -> Floats:
    """Of points (P,3) from the rays through xy (N,P,2), as (N,P) [m]."""
    out = np.empty(xy.shape[:2])
    for i, camera in enumerate(cameras):
        ray = np.concatenate([xy[i], np.ones((xy.shape[1], 1))], axis=-1) @ camera.R
        ray = ray / np.linalg.norm(ray, axis=-1, keepdims=True)
        to_point = points_m - centre(camera)
        out[i] = np.linalg.norm(to_point - ray * np.sum(ray * to_point, -1, keepdims=True), axis=-1)
    return out
