"""Which pixels look like the wearer's bare skin."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel


@kernel
def bare_pixels(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    ids: NDArray[np.uint8],
    skin: NDArray[np.float32],
    threshold: float,
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    tolerance: float,
    out: NDArray[np.bool_],
) -> None:
    """Fill out (h,w), of the region at x0, y0 of picture (H,W,3) BGR: no colour of the shirt in ids (h,w), within
    threshold [standard deviations] of skin, and not as the background was.

    skin (3,4): the whitened distance is |A (b,g,r,1)|. mean (H,W,3), age (H,W) of the background; tolerance: the
    largest channel difference to it, 0..255.
    """
    h, w = ids.shape
    for y in range(h):
        for x in range(w):
            out[y, x] = False
            if ids[y, x] > 0:
                continue
            v, u = y0 + y, x0 + x
            b, g, r = (
                np.float32(picture[v, u, 0]),
                np.float32(picture[v, u, 1]),
                np.float32(picture[v, u, 2]),
            )
            if (
                age[v, u] >= 6
                and abs(b - mean[v, u, 0]) < tolerance
                and abs(g - mean[v, u, 1]) < tolerance
                and abs(r - mean[v, u, 2]) < tolerance
            ):
                continue
            far2 = 0.0
            for i in range(3):
                one = skin[i, 0] * b + skin[i, 1] * g + skin[i, 2] * r + skin[i, 3]
                far2 += one * one
            out[y, x] = far2 < threshold * threshold
