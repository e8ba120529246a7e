"""The pinhole camera with Brown-Conrady distortion: forwards, backwards, and its derivatives."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.types import Camera, Floats

_LEAST_BASELINE_M = 0.02
# points whose undistortion stays in the processor's cache: pictures take half of the time or less
_BLOCK = 1 << 14


def camera_from_world(camera: Camera) -> RigidTransform:
    """The camera's extrinsics."""
    return RigidTransform(camera.R, camera.t_m)


def with_extrinsics(camera: Camera, camera_from_world: RigidTransform) -> Camera:
    """The same camera with other extrinsics."""
    return replace(camera, R=camera_from_world.R, t_m=camera_from_world.t_m)


def to_camera(camera: Camera, world_m: Floats) -> Floats:
    """World points (...,3) in the camera's frame [m]."""
    return world_m @ camera.R.T + camera.t_m


def from_camera(camera: Camera, points_m: Floats) -> Floats:
    """Points (...,3) of the camera's frame in the world [m]."""
    return (points_m - camera.t_m) @ camera.R


def distort(dist: Floats, xy: Floats) -> Floats:
    """Undistorted normalised coordinates (...,2) to distorted ones; dist (5,) = k1 k2 p1 p2 k3.

    Also row by row: dist (N,5) with xy (N,2).
    """
    k1, k2, p1, p2, k3 = dist.T
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ],
        axis=-1,
    )


def distortion_by_point(dist: Floats, xy: Floats) -> Floats:
    """d distorted by undistorted normalised coordinates (...,2,2); shapes as of `distort`."""
    k1, k2, p1, p2, k3 = dist.T
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3))  # of radial, by x, over x
    out = np.empty((*xy.shape, 2))
    out[..., 0, 0] = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x
    out[..., 1, 1] = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x
    out[..., 0, 1] = out[..., 1, 0] = x * y * slope + 2 * p1 * x + 2 * p2 * y
    return out


def distortion_by_coefficients(xy: Floats) -> Floats:
    """d distorted normalised coordinates by k1 k2 p1 p2 k3 (...,2,5); they are linear in them."""
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    out = np.empty((*xy.shape, 5))
    for column, power in ((0, r2), (1, r2**2), (4, r2**3)):
        out[..., column] = xy * power[..., None]
    out[..., 0, 2], out[..., 1, 2] = 2 * x * y, r2 + 2 * y * y
    out[..., 0, 3], out[..., 1, 3] = r2 + 2 * x * x, 2 * x * y
    return out


def perspective_jacobians(xy: Floats, depth_m: Floats) -> Floats:
    """d undistorted normalised coordinates xy (...,2) by the point in the camera's frame (...,2,3)."""
    out = np.zeros((*xy.shape, 3))
    out[..., 0, 0] = out[..., 1, 1] = 1.0 / depth_m
    out[..., :, 2] = -xy / depth_m[..., None]
    return out


def undistort(dist: Floats, xy_distorted: Floats, iterations: int = 20) -> Floats:
    """The inverse of `distort` by fixed-point iteration; converges for the lenses of ordinary webcams."""
    if not dist.any():
        return xy_distorted.copy()
    flat = xy_distorted.reshape(-1, 2)
    if len(flat) > _BLOCK:
        blocks = np.split(flat, range(_BLOCK, len(flat), _BLOCK))
        done = [undistort(dist, block, iterations) for block in blocks]
        return np.concatenate(done).reshape(xy_distorted.shape)
    k1, k2, p1, p2, k3 = dist
    # contiguous, as pictures' grids have many points
    x_distorted, y_distorted = (xy_distorted[..., i].copy() for i in (0, 1))
    x, y = x_distorted, y_distorted
    for _ in range(iterations):
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        across = 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        down = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        x, y = (x_distorted - across) / radial, (y_distorted - down) / radial
    return np.stack([x, y], axis=-1)


def project(camera: Camera, world_m: Floats) -> Floats:
    """World points (...,3) to pixels (...,2); NaN behind the camera."""
    p = to_camera(camera, np.asarray(world_m, dtype=float))
    z = np.where(p[..., 2:] > 1e-6, p[..., 2:], np.nan)
    xy = distort(camera.dist, p[..., :2] / z)
    pixels: Floats = xy * np.array([camera.K[0, 0], camera.K[1, 1]]) + camera.K[:2, 2]
    return pixels


def normalised(camera: Camera, pixels: Floats) -> Floats:
    """Pixels (...,2) to undistorted normalised coordinates (...,2)."""
    xy = (np.asarray(pixels, dtype=float) - camera.K[:2, 2]) / np.array(
        [camera.K[0, 0], camera.K[1, 1]]
    )
    return undistort(camera.dist, xy)


def rays(camera: Camera, pixels: Floats) -> tuple[Floats, Floats]:
    """The camera's centre (3,) and unit directions (...,3) of pixels (...,2), in the world."""
    xy = normalised(camera, pixels)
    d = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1)
    d = d / np.linalg.norm(d, axis=-1, keepdims=True)
    return centre(camera), d @ camera.R


def centre(camera: Camera) -> Floats:
    """The optical centre (3,) in the world [m]."""
    return -camera.R.T @ camera.t_m


def sees_from_one_place(cameras: Sequence[Camera]) -> bool:
    """True for one camera, and for cameras whose optical centres are the same by their calibration."""
    first_m = centre(cameras[0])
    return all(np.linalg.norm(centre(one) - first_m) < _LEAST_BASELINE_M for one in cameras)


def common_place(cameras: Sequence[Camera]) -> Floats:
    """The point (3,) that is nearest to the optical axes of all cameras [m]."""
    total, right = 1e-6 * np.eye(3), np.zeros(3)
    for camera in cameras:
        across = np.eye(3) - np.outer(camera.R[2], camera.R[2])
        total += across
        right += across @ centre(camera)
    return np.asarray(np.linalg.solve(total, right), np.float64)
