"""Where the body as drawn is nearer or farther than what is seen there."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.vision.raster_kernels import NOTHING


@njit(cache=True, nogil=True)
def compare_depths(
    drawn_m: NDArray[np.float32],
    triangle_at: NDArray[np.int32],
    patch: NDArray[np.uint8],
    seen_m: NDArray[np.float32],
    off_m: float,
    asked: NDArray[np.float64],
    off: NDArray[np.float64],
) -> float:
    """Squared differences of all pixels, in those of off_m, at most 1 each, summed.

    drawn_m, seen_m (h,w): depths, NaN where none is seen; triangle_at (h,w): what is drawn; patch (T,): of its triangles.
    Adds to asked (L,), by patch, the pixels compared, and to off (L,) those that differ by more than off_m.
    """
    cost = 0.0
    h, w = seen_m.shape
    for y in range(h):
        for x in range(w):
            t = triangle_at[y, x]
            if t == NOTHING or np.isnan(seen_m[y, x]):
                continue
            away = abs(drawn_m[y, x] - seen_m[y, x]) / off_m
            asked[patch[t]] += 1.0
            if away > 1.0:
                off[patch[t]] += 1.0
            cost += min(away * away, 1.0)
    return cost
