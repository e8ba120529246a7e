"""What stands before a known background, and its shadow."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

BACKGROUND, BEFORE, UNKNOWN, SHADOW, CLOTH_OR_SHADOW = 0, 1, 2, 3, 4


@njit(cache=True, nogil=True)
def stands_before(
    picture: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    known: int,
    tolerance: float,
    sure: tuple[float, float],
    likely: tuple[float, float],
    out: NDArray[np.uint8],
) -> None:
    """out (h,w): UNKNOWN where the background was seen fewer than `known` times, BEFORE where a channel differs from it
    by more than `tolerance`, BACKGROUND elsewhere.

    picture (h,w,3); mean (h,w,3) 0..255 and age (h,w) of the background. A shadow is the background dimmed in all channels
    alike (Horprasert et al. 1999): `sure` and `likely` are to which share at least, and how far the colour may then be off.
    A sure one is SHADOW, where cloth of the background's colour is seldom, a likely one CLOTH_OR_SHADOW.
    """
    h, w, _ = picture.shape
    for y in range(h):
        for x in range(w):
            if age[y, x] < known:
                out[y, x] = UNKNOWN
                continue
            most, along, length2 = np.float32(0.0), np.float32(0.0), np.float32(1.0)
            for c in range(3):
                a, m = np.float32(picture[y, x, c]), mean[y, x, c]
                most = max(most, abs(a - m))
                along += a * m
                length2 += m * m
            if most <= tolerance:
                out[y, x] = BACKGROUND
                continue
            share = along / length2
            out[y, x] = BEFORE
            if share >= 1.0 or share < likely[0]:
                continue
            off = np.float32(0.0)
            for c in range(3):
                off = max(off, abs(np.float32(picture[y, x, c]) - share * mean[y, x, c]))
            if share > sure[0] and off < sure[1]:
                out[y, x] = SHADOW
            elif off < likely[1]:
                out[y, x] = CLOTH_OR_SHADOW


def stands(before: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """(h,w): where something is, or throws a shadow, before a background that is known."""
    there: NDArray[np.bool_] = (before != BACKGROUND) & (before != UNKNOWN)
    return there
