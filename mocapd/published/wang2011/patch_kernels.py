"""Compiled parts of the centroid method: patches on rendered and classified id maps, their derivatives."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PinholeArrays, PosedJoints, TriangleArrays
from mocapd.body.derivative_kernels import surface_row
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Int32 = NDArray[np.int32]


@kernel
def rendered_patches(
    triangle_at: Int32, patch: Bytes, samples: NDArray[np.int64], count: Array, centroid: Array
) -> None:
    """Samples seen per triangle (T,); per patch, an `Area`, their count (A,) and mean x, y (A,2)."""
    samples[:] = 0
    count[:] = 0.0
    centroid[:] = 0.0
    h, w = triangle_at.shape
    for y in range(h):
        for x in range(w):
            t = triangle_at[y, x]
            if t < 0:
                continue
            samples[t] += 1
            p = patch[t]
            count[p] += 1.0
            centroid[p, 0] += x
            centroid[p, 1] += y
    for p in range(count.shape[0]):
        if count[p] > 0.0:
            centroid[p, 0] /= count[p]
            centroid[p, 1] /= count[p]


@kernel
def classified_patches(
    ids: Bytes,
    nearest_yx: NDArray[np.int16],
    triangle_at: Int32,
    patch: Bytes,
    count: Array,
    centroid: Array,
) -> None:
    """Count (A,) and mean x, y (A,2) of the classified samples (h,w) of each patch.

    Each colour is on two patches: a sample belongs to the one whose rendered sample of that colour is
    nearest, nearest_yx (10,h,w,2).
    """
    count[:] = 0.0
    centroid[:] = 0.0
    h, w = ids.shape
    for y in range(h):
        for x in range(w):
            k = ids[y, x]
            if k == 0:
                continue
            row, column = nearest_yx[k - 1, y, x, 0], nearest_yx[k - 1, y, x, 1]
            if row < 0:
                continue
            p = patch[triangle_at[row, column]]
            count[p] += 1.0
            centroid[p, 0] += x
            centroid[p, 1] += y
    for p in range(count.shape[0]):
        if count[p] > 0.0:
            centroid[p, 0] /= count[p]
            centroid[p, 1] /= count[p]


@kernel
def inner_ids(triangle_at: Int32, colour: Bytes, out: Bytes) -> None:
    """Colour ids (h,w) of the rendered samples whose four neighbours have the same colour, else 0."""
    h, w = triangle_at.shape
    out[:] = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            t = triangle_at[y, x]
            if t < 0:
                continue
            c = colour[t]
            same = True
            for a, b in ((-1, 0), (1, 0), (0, -1), (0, 1)):
                s = triangle_at[y + a, x + b]
                if s < 0 or colour[s] != c:
                    same = False
            if same:
                out[y, x] = c


@kernel
def centroid_rows(
    samples: NDArray[np.int64],
    wanted: NDArray[np.bool_],
    count: Array,
    points: Array,
    patch: Bytes,
    surface: TriangleArrays,
    articulation: Articulation,
    posed: PosedJoints,
    camera: PinholeArrays,
    out: Array,
) -> None:
    """d centroid [px] / d pose step of the wanted patches: out (A, 2, 3 + 3 G).

    The centroid is taken as the mean over the samples seen of each triangle's centre, with the set of
    samples held fixed and the lens' distortion left out of the derivative.
    """
    _, bones, weights, _ = surface
    rest, R, joints, _ = posed
    cam_R, cam_t, fx, fy = camera
    columns = out.shape[2]
    row = np.empty(columns)
    g = np.empty(3)
    world, seen = np.empty(3), np.empty(3)
    out[:] = 0.0
    for t in range(samples.shape[0]):
        p = patch[t]
        if samples[t] == 0 or not wanted[p]:
            continue
        world[:] = 0.0
        for b in range(bones.shape[1]):
            j, w = bones[t, b], weights[t, b]
            for i in range(3):
                value = joints[j, i]
                for k in range(3):
                    value += R[j, i, k] * (points[t, k] - rest[j, k])
                world[i] += w * value
        for i in range(3):
            seen[i] = cam_t[i]
            for k in range(3):
                seen[i] += cam_R[i, k] * world[k]
        z = max(seen[2], 0.1)
        share = samples[t] / count[p]
        for axis in range(2):
            f = fx if axis == 0 else fy
            for k in range(3):
                g[k] = f / z * (cam_R[axis, k] - seen[axis] / z * cam_R[2, k])
            surface_row(points[t], bones[t], weights[t], g, articulation, posed, row)
            for k in range(columns):
                out[p, axis, k] += share * row[k]
