"""Derivatives of the patches' centroids."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, PinholeArrays, PosedJoints, TriangleArrays
from mocapd.body.derivative_kernels import surface_row
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]


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
    _, bones, weights, _, _ = surface
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
