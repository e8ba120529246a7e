"""A patch of one picture looked for in another, for each distance that it may have."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import CameraArrays
from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.head.projection_kernels import BEHIND, pixel_of
from mocapd.published.hecht2009.head.sampling_kernels import grey_at

Array = NDArray[np.float64]


@kernel
def sweep(
    centre: Array,
    rays: Array,
    lateral: Array,
    values: Array,
    distances: Array,
    radius: float,
    camera: CameraArrays,
    grey: NDArray[np.uint8],
    out: Array,
) -> None:
    """Fill out (D,) with the zero-mean normalised cross-correlation of a ball's front; -1 where it leaves the picture.

    The patch: unit rays (N,3) in the world from a camera's centre (3,), tangents of their angle from the
    patch's middle ray (N,), grey values (N,). distances (D,) of the ball's middle along the middle ray [m],
    radius [m]; 0: the patch is flat and faces its camera. The other view: camera, grey (h,w).
    """
    n = len(rays)
    seen = np.empty(n)
    for d in range(len(distances)):
        out[d] = -1.0
        sum_a = sum_b = sum_aa = sum_bb = sum_ab = 0.0
        complete = True
        for i in range(n):
            side = lateral[i] * distances[d]
            front = np.sqrt(max(radius * radius - side * side, 0.0))
            # the middle ray's distance over the cosine: a plane that faces the camera, bulged by the ball
            reach = (distances[d] - front) * np.sqrt(1.0 + lateral[i] * lateral[i])
            x, y, z = pixel_of(
                camera,
                centre[0] + reach * rays[i, 0],
                centre[1] + reach * rays[i, 1],
                centre[2] + reach * rays[i, 2],
            )
            seen[i] = grey_at(grey, x, y) if z > BEHIND else -1.0
            if seen[i] < 0.0:
                complete = False
                break
            a, b = values[i], seen[i]
            sum_a += a
            sum_b += b
            sum_aa += a * a
            sum_bb += b * b
            sum_ab += a * b
        if not complete:
            continue
        var_a, var_b = sum_aa - sum_a * sum_a / n, sum_bb - sum_b * sum_b / n
        if var_a > 1e-6 and var_b > 1e-6:
            out[d] = (sum_ab - sum_a * sum_b / n) / np.sqrt(var_a * var_b)
