"""Kernel: pixels that show the floor about a person."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel


@kernel
def near_on_floor(
    met_x: NDArray[np.float32],
    met_z: NDArray[np.float32],
    left: int,
    top: int,
    x_m: float,
    z_m: float,
    reach_m: float,
    out: NDArray[np.uint8],
) -> None:
    """out (h,w), of a part of the picture that begins at `left` and `top`: 1 where a pixel meets the floor at met_x, met_z
    (H,W) [m] within reach_m of x_m, z_m, else 0."""
    h, w = out.shape
    x0, z0 = np.float32(x_m), np.float32(z_m)
    reach2 = np.float32(reach_m * reach_m)
    for y in range(h):
        xs, zs = met_x[top + y, left : left + w], met_z[top + y, left : left + w]
        for x in range(w):
            across, along = xs[x] - x0, zs[x] - z0
            is_near = across * across + along * along < reach2
            out[y, x] = np.uint8(1) if is_near else np.uint8(0)
