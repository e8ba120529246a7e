"""How far along a ray something is: a patch of one picture looked for in another, along the ray's image there."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def _patch(grey: NDArray[np.uint8], x: float, y: float, half: int, out: Array) -> float:
    """Fill out ((2 half + 1)^2,) with the patch about x, y, less its mean; its length, 0 where it leaves the picture."""
    h, w = grey.shape
    if x < half or y < half or x >= w - 1 - half or y >= h - 1 - half:
        return 0.0
    # pixels of a patch lie alike between those of the picture: the weights of `grey_at` are the same for all
    left, top = int(x) - half, int(y) - half
    a, b = x - int(x), y - int(y)
    upper_left, upper_right = (1.0 - b) * (1.0 - a), (1.0 - b) * a
    lower_left, lower_right = b * (1.0 - a), b * a
    side = 2 * half + 1
    total = 0.0
    for j in range(side):
        row, below = grey[top + j], grey[top + j + 1]
        line = out[j * side : (j + 1) * side]
        for i in range(side):
            value = (
                upper_left * row[left + i]
                + upper_right * row[left + i + 1]
                + lower_left * below[left + i]
                + lower_right * below[left + i + 1]
            )
            line[i] = value
            total += value
    n = side * side
    total /= n
    squares = 0.0
    for k in range(n):
        out[k] -= total
        squares += out[k] * out[k]
    length: float = np.sqrt(squares)
    return length


@njit(cache=True, nogil=True)
def match_along_rays(
    grey: NDArray[np.uint8],
    other: NDArray[np.uint8],
    at_px: Array,
    there_px: Array,
    half: int,
    least_contrast: float,
    place: Array,
    alike: Array,
) -> None:
    """Where along each ray the pictures agree best, by zero-mean normalised cross-correlation of patches.

    grey, other (h,w); at_px (N,2): the rays' pixels in the first; there_px (N,K,2): where K places along each ray show
    in the other, NaN for none. Fills place (N,), 0..K-1 between places, and alike (N,), the correlation there; alike
    is -1 where the patch has less contrast (standard deviation, grey values) or the best place is at an end.
    """
    size = (2 * half + 1) ** 2
    mine, its = np.empty(size), np.empty(size)
    n_places = there_px.shape[1]
    scores = np.empty(n_places)
    for n in range(at_px.shape[0]):
        place[n], alike[n] = 0.0, -1.0
        length = _patch(grey, at_px[n, 0], at_px[n, 1], half, mine)
        if length < least_contrast * np.sqrt(float(size)):
            continue
        best = 0
        for k in range(n_places):
            scores[k] = -1.0
            x, y = there_px[n, k, 0], there_px[n, k, 1]
            if not (np.isfinite(x) and np.isfinite(y)):
                continue
            other_length = _patch(other, x, y, half, its)
            if other_length > 0.0:
                product = 0.0
                for i in range(size):
                    product += mine[i] * its[i]
                scores[k] = product / (length * other_length)
            if scores[k] > scores[best]:
                best = k
        if best == 0 or best == n_places - 1:
            continue
        bend = scores[best - 1] - 2.0 * scores[best] + scores[best + 1]
        beside = 0.5 * (scores[best - 1] - scores[best + 1]) / bend if bend < -1e-6 else 0.0
        place[n], alike[n] = best + min(max(beside, -0.5), 0.5), scores[best]
