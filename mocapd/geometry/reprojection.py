"""Projection of points into many cameras, and its derivatives by points and intrinsics.

One row per observation, each with the intrinsics of its own camera: the camera model of
`camera_model`, row by row and with its Jacobians.
"""

import numpy as np

from mocapd.geometry.camera_model import (
    distort,
    distortion_by_coefficients,
    distortion_by_point,
    perspective_jacobians,
)
from mocapd.types import Floats

INTRINSICS = 9  # fx fy cx cy k1 k2 p1 p2 k3
_NEAREST_M = 1e-3  # lower bound of the depth, also for points behind


def intrinsics_row(K: Floats, dist: Floats) -> Floats:
    """(9,): fx fy cx cy k1 k2 p1 p2 k3."""
    return np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2], *dist])


def camera_matrix(row: Floats) -> Floats:
    """K (3,3) of a row of intrinsics."""
    fx, fy, cx, cy = row[:4]
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def project_rows(intrinsics: Floats, points_m: Floats) -> Floats:
    """Pixels (N,2) of points (N,3) in their cameras' frames; intrinsics (N,9)."""
    xy = points_m[:, :2] / np.maximum(points_m[:, 2:], _NEAREST_M)
    pixels: Floats = distort(intrinsics[:, 4:], xy) * intrinsics[:, :2] + intrinsics[:, 2:4]
    return pixels


def projection_jacobians(intrinsics: Floats, points_m: Floats) -> tuple[Floats, Floats]:
    """d pixels by intrinsics (N,2,9) and by points in the cameras' frames (N,2,3)."""
    depth_m = np.maximum(points_m[:, 2], _NEAREST_M)
    xy = points_m[:, :2] / depth_m[:, None]
    dist, focal_px = intrinsics[:, 4:], intrinsics[:, :2, None]
    by_intrinsics = np.zeros((len(xy), 2, INTRINSICS))
    by_intrinsics[:, 0, 0], by_intrinsics[:, 1, 1] = distort(dist, xy).T
    by_intrinsics[:, 0, 2] = by_intrinsics[:, 1, 3] = 1.0
    by_intrinsics[:, :, 4:] = focal_px * distortion_by_coefficients(xy)
    by_xy = focal_px * distortion_by_point(dist, xy)
    return by_intrinsics, by_xy @ perspective_jacobians(xy, depth_m)
