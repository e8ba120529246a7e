"""What stands before a known background, its shadow left out."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

BACKGROUND, BEFORE, UNKNOWN = 0, 1, 2


@njit(cache=True, nogil=True)
def stands_before(
    picture: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    known: int,
    tolerance: float,
    darkest: float,
    tint: float,
    out: NDArray[np.uint8],
) -> None:
    """out (h,w): UNKNOWN where the background was seen fewer than `known` times, BEFORE where a channel differs from it
    by more than `tolerance`, BACKGROUND elsewhere.

    picture (h,w,3); mean (h,w,3) 0..255 and age (h,w) of the background. A shadow is darker in all channels alike
    (Horprasert et al. 1999): down to `darkest` of the background, with ratios that differ by less than `tint`, and is
    BACKGROUND.
    """
    h, w, _ = picture.shape
    for y in range(h):
        for x in range(w):
            if age[y, x] < known:
                out[y, x] = UNKNOWN
                continue
            most = np.float32(0.0)
            low, high = np.float32(1e9), np.float32(0.0)
            for c in range(3):
                a, m = np.float32(picture[y, x, c]), mean[y, x, c]
                most = max(most, abs(a - m))
                ratio = (a + np.float32(4.0)) / (m + np.float32(4.0))
                low, high = min(low, ratio), max(high, ratio)
            shadow = high < 1.0 and low > darkest and high - low < tint * high
            out[y, x] = BEFORE if most > tolerance and not shadow else BACKGROUND
