"""Points on rays of one camera, and where they show in the picture of another one; and pixels
spread evenly over every region of every part of a drawn body."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import CameraArrays
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
_IDS = 16  # as `surface_labels.MAX_LABELS`
N_PARTS = 16  # of the body, fewer than that
N_GROUPS = N_PARTS * _IDS


@kernel
def _shown(camera: CameraArrays, x: float, y: float, z: float, out: Array) -> None:
    """Fill out (2,) with where a point of the world shows, NaN behind the camera; see `camera_model.project`."""
    R, t, K, dist = camera
    depth = R[2, 0] * x + R[2, 1] * y + R[2, 2] * z + t[2]
    if not depth > 1e-6:
        out[:] = np.nan
        return
    u = (R[0, 0] * x + R[0, 1] * y + R[0, 2] * z + t[0]) / depth
    v = (R[1, 0] * x + R[1, 1] * y + R[1, 2] * z + t[1]) / depth
    k1, k2, p1, p2, k3 = dist[0], dist[1], dist[2], dist[3], dist[4]
    r2 = u * u + v * v
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    out[0] = K[0, 0] * (u * radial + 2.0 * p1 * u * v + p2 * (r2 + 2.0 * u * u)) + K[0, 2]
    out[1] = K[1, 1] * (v * radial + p1 * (r2 + 2.0 * v * v) + 2.0 * p2 * u * v) + K[1, 2]


@kernel
def shown_on_rays(
    camera: CameraArrays, origin_m: Array, along: Array, distance_m: Array, out: Array
) -> None:
    """Fill out (N,K,2) with where points show that are distance_m (N,K) from origin_m (3,) along unit vectors (N,3)."""
    for n in range(distance_m.shape[0]):
        for k in range(distance_m.shape[1]):
            d = distance_m[n, k]
            x, y, z = (
                origin_m[0] + d * along[n, 0], origin_m[1] + d * along[n, 1], origin_m[2] + d * along[n, 2]
            )  # fmt: skip
            _shown(camera, x, y, z, out[n, k])


@kernel
def evenly_between(one: Array, other: Array, out: Array) -> None:
    """Fill out (N,K,2) with places that lead in even steps from `one` to `other` (N,2)."""
    last = out.shape[1] - 1
    for n in range(out.shape[0]):
        for k in range(out.shape[1]):
            share = k / last
            for i in range(2):
                out[n, k, i] = one[n, i] + share * (other[n, i] - one[n, i])


@kernel
def taken_at(y: Ints, x: Ints, scale: int, rays: Array, pixels: Array, out: Array) -> None:
    """Fill pixels (N,2) with the middles of work pixels (N,) in the pictures as delivered, and out (N,3) with their unit
    vectors of rays (h,w,3)."""
    for n in range(len(y)):
        pixels[n, 0], pixels[n, 1] = (x[n] + 0.5) * scale - 0.5, (y[n] + 0.5) * scale - 0.5
        for i in range(3):
            out[n, i] = rays[y[n], x[n], i]


@kernel
def distances_of_triangles(
    triangle: Ints,
    bones: NDArray[np.int32],
    weights: Array,
    centres: Array,
    rest: Array,
    R: Array,
    joints: Array,
    origin_m: Array,
    along: Array,
    out: Array,
) -> None:
    """Fill out (N,) with how far triangles (N,) are from origin_m (3,) along unit vectors (N,3).

    bones, weights (T,k), centres (T,3) of all triangles; rest (J,3); R (J,3,3), joints (J,3) of the body as posed.
    """
    for n in range(len(triangle)):
        t, distance = triangle[n], 0.0
        for i in range(3):
            middle = 0.0
            for b in range(bones.shape[1]):
                j = bones[t, b]
                there = joints[j, i]
                for k in range(3):
                    there += R[j, i, k] * (centres[t, k] - rest[j, k])
                middle += weights[t, b] * there
            distance += (middle - origin_m[i]) * along[n, i]
        out[n] = distance


@kernel
def _group(
    ids: NDArray[np.uint8],
    triangle_at: NDArray[np.int32],
    part: NDArray[np.uint8],
    y: int,
    x: int,
    edge: int,
) -> int:
    """Of a pixel that is drawn and so are those `edge` beside it each way; else -1."""
    if (
        ids[y, x] == 0
        or ids[y - edge, x] == 0
        or ids[y + edge, x] == 0
        or ids[y, x - edge] == 0
        or ids[y, x + edge] == 0
    ):
        return -1
    return int(part[triangle_at[y, x]]) * _IDS + int(ids[y, x])


@kernel
def spread_over_groups(
    ids: NDArray[np.uint8],
    triangle_at: NDArray[np.int32],
    part: NDArray[np.uint8],
    edge: int,
    points: NDArray[np.int64],
    turn: int,
    out: NDArray[np.int64],
) -> int:
    """Fill out (N,2) with rows and columns of pixels of ids (h,w), group after group, of each at most the points (16,) of its
    part and evenly over it; how many there are.

    A group is an id on a part, part (T,) of the triangles in triangle_at (h,w). Only pixels from whose place the body goes
    on for `edge` each way; turn: a running number, by which others are taken.
    """
    h, w = ids.shape
    count = np.zeros(N_GROUPS, np.int64)
    for y in range(edge, h - edge):
        for x in range(edge, w - edge):
            group = _group(ids, triangle_at, part, y, x, edge)
            if group >= 0:
                count[group] += 1
    step, first = np.empty(N_GROUPS, np.int64), np.empty(N_GROUPS, np.int64)
    place, end = np.empty(N_GROUPS, np.int64), np.empty(N_GROUPS, np.int64)
    total = 0
    for group in range(N_GROUPS):
        most = points[group // _IDS]
        step[group] = max(count[group] // most, 1)
        first[group] = turn % step[group]
        place[group] = total
        left = count[group] - first[group]
        total += min((left + step[group] - 1) // step[group], most) if left > 0 else 0
        end[group] = total
    count[:] = 0
    for y in range(edge, h - edge):
        for x in range(edge, w - edge):
            group = _group(ids, triangle_at, part, y, x, edge)
            if group < 0:
                continue
            k = count[group] - first[group]
            count[group] += 1
            if k >= 0 and k % step[group] == 0 and place[group] < end[group]:
                out[place[group], 0], out[place[group], 1] = y, x
                place[group] += 1
    return total
