"""Compiled pass of the edge image: clear gradients, their directions, and which of them move."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Shorts = NDArray[np.int16]
FULL = 1024  # of what counts as a whole edge


@kernel(error_model="numpy")
def mark_edges(
    dx: Shorts,
    dy: Shorts,
    difference: NDArray[np.uint8],
    least_gradient: int,
    least_difference: int,
    full: int,
    still: int,
    out: Shorts,
) -> None:
    """out (h,w,3): strength, and strength times cosine and sine of twice the gradient's angle: twice, as light on dark
    and dark on light are one outline, so that the mean of neighbours says what they have in common.

    Strength: 0 where |dx| + |dy| is less than least_gradient, `full` where the difference of two pictures is clear
    too, else `still`.
    """
    h, w, _ = out.shape
    for y in range(h):
        for x in range(w):
            a, b = np.float32(dx[y, x]), np.float32(dy[y, x])
            strength = np.float32(full if difference[y, x] >= least_difference else still)
            if abs(a) + abs(b) < least_gradient:
                strength = np.float32(0.0)
            f = strength / max(a * a + b * b, np.float32(1.0))
            out[y, x, 0] = np.int16(strength)
            out[y, x, 1] = np.int16(f * (a * a - b * b))
            out[y, x, 2] = np.int16(f * np.float32(2.0) * a * b)
