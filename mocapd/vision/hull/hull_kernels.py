"""Rays clipped against silhouettes along epipolar lines, and log-odds summed over cameras at points."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_NEAREST_M = 0.05  # along a camera's axis: nearer points, and those behind it, are out of view
_MOST_STEPS = 4096  # along one epipolar line


@kernel(error_model="numpy")
def _pixel(
    x: float, y: float, focal: Array, dist: Array, width: int, height: int
) -> tuple[int, int]:
    """Column and row of the pixel at undistorted normalised coordinates; -1, -1 outside of the picture."""
    r2 = x * x + y * y
    radial = 1.0 + r2 * (dist[0] + r2 * (dist[1] + r2 * dist[4]))
    u = focal[0] * (x * radial + 2.0 * dist[2] * x * y + dist[3] * (r2 + 2.0 * x * x)) + focal[2]
    v = focal[1] * (y * radial + dist[2] * (r2 + 2.0 * y * y) + 2.0 * dist[3] * x * y) + focal[3]
    if not (u >= -0.5 and v >= -0.5 and u < width - 0.5 and v < height - 0.5):
        return -1, -1
    return int(np.floor(u + 0.5)), int(np.floor(v + 0.5))


@kernel(error_model="numpy")
def _walk(
    origin: Array,
    way: Array,
    start_m: float,
    end_m: float,
    mask: NDArray[np.uint8],
    focal: Array,
    dist: Array,
    width: int,
    height: int,
    step_px: float,
    found: Array,
    n_found: int,
) -> int:
    """Append to found (K,2) the parts of one interval [start_m, end_m] of a ray that are inside a camera's mask (h,w); how
    many there are then. origin, way (3,): the ray in that camera's frame. What the camera does not see stays inside."""
    begin, end = start_m, end_m
    z0, z1 = origin[2] + start_m * way[2], origin[2] + end_m * way[2]
    if z0 < _NEAREST_M and z1 < _NEAREST_M:
        begin = end
    elif z0 < _NEAREST_M:
        begin = (_NEAREST_M - origin[2]) / way[2]
    elif z1 < _NEAREST_M:
        end = (_NEAREST_M - origin[2]) / way[2]
    z0, z1 = origin[2] + begin * way[2], origin[2] + end * way[2]
    x0, y0 = (origin[0] + begin * way[0]) / z0, (origin[1] + begin * way[1]) / z0
    x1, y1 = (origin[0] + end * way[0]) / z1, (origin[1] + end * way[1]) / z1
    steps = 1
    if end > begin:
        long_px = np.hypot((x1 - x0) * focal[0], (y1 - y0) * focal[1])
        steps = int(min(max(long_px / step_px, 1.0), _MOST_STEPS))
    inside, opened = begin > start_m or begin == end, start_m
    for k in range(steps + 1 if end > begin else 0):
        s = k / steps
        column, row = _pixel(x0 + s * (x1 - x0), y0 + s * (y1 - y0), focal, dist, width, height)
        here = column < 0 or mask[row, column] != 0
        if here != inside:
            # half a step back; along the ray by the depths, as the picture shortens what is far away
            s = max(k - 0.5, 0.0) / steps
            at_m = (begin * z1 * (1.0 - s) + end * z0 * s) / (z1 * (1.0 - s) + z0 * s)
            if here:
                opened = start_m if k == 0 and begin == start_m else at_m
            elif at_m > opened and n_found < len(found):
                found[n_found, 0], found[n_found, 1] = opened, at_m
                n_found += 1
            inside = here
    if (inside or end < end_m) and n_found < len(found):
        found[n_found, 0], found[n_found, 1] = opened if inside else end, end_m
        n_found += 1
    return n_found


@kernel(error_model="numpy")
def clip_rays(
    eye_m: Array,
    ways: Array,
    reach_m: Array,
    own: int,
    masks: NDArray[np.uint8],
    R: Array,
    t_m: Array,
    focal_px: Array,
    dist: Array,
    size_px: Ints,
    step_px: float,
    intervals_m: Array,
    counts: Ints,
) -> None:
    """Which parts of rays are inside the silhouettes of all cameras but their own.

    eye_m (3,), ways (N,3) of length 1: the rays; reach_m (N,2): from where to where each is looked along, nowhere if the
    second is the lesser; own: the camera whose rays they are; masks (C,h,w), 0 is background, with projections R, t_m,
    focal_px, dist, size_px as of `StackProjections`; step_px: along epipolar lines. Fills intervals_m (N,K,2), in order
    and disjoint, and counts (N,). More than K intervals of a ray: the farther ones are dropped.
    """
    most = intervals_m.shape[1]
    now, then = np.empty((most, 2)), np.empty((most, 2))
    origins = np.empty((len(masks), 3))
    way = np.empty(3)
    for c in range(len(masks)):
        for i in range(3):
            origins[c, i] = (
                t_m[c, i] + R[c, i, 0] * eye_m[0] + R[c, i, 1] * eye_m[1] + R[c, i, 2] * eye_m[2]
            )
    for n in range(len(ways)):
        counts[n] = 0
        if not reach_m[n, 1] > reach_m[n, 0]:
            continue
        now[0, 0], now[0, 1] = reach_m[n, 0], reach_m[n, 1]
        n_now = 1
        for c in range(len(masks)):
            if c == own or n_now == 0:
                continue
            for i in range(3):
                way[i] = R[c, i, 0] * ways[n, 0] + R[c, i, 1] * ways[n, 1] + R[c, i, 2] * ways[n, 2]
            n_then = 0
            for k in range(n_now):
                n_then = _walk(
                    origins[c], way, now[k, 0], now[k, 1], masks[c], focal_px[c], dist[c],
                    size_px[c, 0], size_px[c, 1], step_px, then, n_then,
                )  # fmt: skip
            now, then = then, now
            n_now = n_then
        counts[n] = n_now
        for k in range(n_now):
            intervals_m[n, k, 0], intervals_m[n, k, 1] = now[k, 0], now[k, 1]


@kernel(error_model="numpy")
def sum_at_points(
    points_m: Array,
    maps: NDArray[np.float32],
    R: Array,
    t_m: Array,
    focal_px: Array,
    dist: Array,
    size_px: Ints,
    unseen: float,
    sums: NDArray[np.float32],
    seen_by: NDArray[np.uint8],
) -> None:
    """Sum what the maps (C,h,w) of all cameras hold at the images of points (P,3) [m, world].

    Projections as of `StackProjections`; unseen: what a camera adds for a point out of its view. Fills sums (P,) and
    seen_by (P,), how many cameras have the point in view.
    """
    for n in range(len(points_m)):
        x, y, z = points_m[n, 0], points_m[n, 1], points_m[n, 2]
        total, seen = np.float32(0.0), 0
        for c in range(len(maps)):
            depth = R[c, 2, 0] * x + R[c, 2, 1] * y + R[c, 2, 2] * z + t_m[c, 2]
            column, row = -1, -1
            if depth >= _NEAREST_M:
                across = R[c, 0, 0] * x + R[c, 0, 1] * y + R[c, 0, 2] * z + t_m[c, 0]
                down = R[c, 1, 0] * x + R[c, 1, 1] * y + R[c, 1, 2] * z + t_m[c, 1]
                column, row = _pixel(
                    across / depth, down / depth, focal_px[c], dist[c], size_px[c, 0], size_px[c, 1]
                )
            if column < 0:
                total += np.float32(unseen)
            else:
                total += maps[c, row, column]
                seen += 1
        sums[n], seen_by[n] = total, seen
