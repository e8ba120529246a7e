"""The pinhole camera with Brown-Conrady distortion, forwards and backwards."""

import numpy as np

from mocapd.types import Camera, Floats


def to_camera(camera: Camera, world_m: Floats) -> Floats:
    """World points (...,3) in the camera's frame [m]."""
    return world_m @ camera.R.T + camera.t_m


def distort(dist: Floats, xy: Floats) -> Floats:
    """Undistorted normalised coordinates (...,2) to distorted ones; dist = k1 k2 p1 p2 k3."""
    k1, k2, p1, p2, k3 = dist
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


def undistort(dist: Floats, xy_distorted: Floats, iterations: int = 20) -> Floats:
    """The inverse of `distort` by fixed-point iteration; converges for the lenses of ordinary webcams."""
    k1, k2, p1, p2, k3 = dist
    xy = xy_distorted
    for _ in range(iterations):
        x, y = xy[..., 0], xy[..., 1]
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        tangential = np.stack(
            [2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y],
            axis=-1,
        )
        xy = (xy_distorted - tangential) / radial[..., None]
    return xy


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
