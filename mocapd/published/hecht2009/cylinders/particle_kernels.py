"""Compiled motion of particles: constant velocity and the mixture of two noises [Hecht et al. 2009, section III.A]."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.cylinders.cylinder_projection_kernels import (
    NEAREST_M,
    pixel_at,
    to_camera_frame,
)
from mocapd.published.hecht2009.cylinders.work_camera import WorkCamera
from mocapd.published.hecht2009.vector_kernels import Array, dot, minus, move


class NoiseDraws(NamedTuple):
    """Random numbers of one step for N particles: choice, view (N,) uniform in 0..1; spread (N,3,3), depth (N,3) normal."""

    choice: Array
    view: Array
    spread: Array
    depth: Array


@kernel(error_model="numpy")
def motion_at(
    points: Array,
    camera: WorkCamera,
    motion: NDArray[np.uint8],
    size: tuple[int, int],
    out: Array,
) -> None:
    """Raise out (N,3) to the motion image's value, 0..1, at each point (N,3,3) [m, world]; size: width and height of
    the work picture [px]. Outside of the picture nothing moves."""
    _, _, K, dist, far_r2 = camera
    h, w = motion.shape
    sx, sy = w / size[0], h / size[1]
    p = np.empty(3)
    for n in range(points.shape[0]):
        for i in range(3):
            to_camera_frame(camera, points[n, i], p)
            if p[2] < NEAREST_M:
                continue
            x, y = pixel_at(K, dist, far_r2, p[0], p[1], p[2])
            u, v = (x + 0.5) * sx, (y + 0.5) * sy
            if u >= 0.0 and u < w and v >= 0.0 and v < h:
                out[n, i] = max(out[n, i], motion[int(v), int(u)] * (1.0 / 255.0))


@kernel(error_model="numpy")
def scatter(
    points: Array,
    variance: Array,
    centres: Array,
    depth_sd: Array,
    depth_share: float,
    draws: NoiseDraws,
) -> None:
    """Add noise to points (N,3,3) [m]: of variance (N,3) [m^2] each way, or along a ray from one of the cameras' centres
    (V,3) with depth_sd (3,) [m], which `depth_share` of the particles do. A point is not moved behind its camera."""
    choice, view, spread, depth = draws
    n_views = centres.shape[0]
    for n in range(points.shape[0]):
        if choice[n] < depth_share and n_views > 0:
            v = min(int(view[n] * n_views), n_views - 1)
            for i in range(3):
                ray = minus(points[n, i], centres[v])
                far = np.sqrt(dot(ray, ray))
                if far >= NEAREST_M:
                    f = max(depth_sd[i] * depth[n, i] / far, NEAREST_M / far - 1.0)
                    move(points[n, i], f, ray)
        else:
            for i in range(3):
                move(points[n, i], np.sqrt(variance[n, i]), spread[n, i])
