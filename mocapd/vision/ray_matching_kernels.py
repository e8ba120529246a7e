"""How far along a ray something is: a patch of one picture looked for in another, along the ray's image there."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


_TOGETHER = 4  # patches whose sums are added up side by side: each waits for its last addition


@njit(cache=True, nogil=True)
def _patch(grey: NDArray[np.uint8], x: float, y: float, half: int, out: Array) -> bool:
    """Fill out ((2 half + 1)^2,) with the patch about x, y; False where it leaves the picture."""
    h, w = grey.shape
    if not (x >= half and y >= half and x < w - 1 - half and y < h - 1 - half):
        return False
    # pixels of a patch lie alike between those of the picture: the weights of `grey_at` are the same for all
    left, top = int(x) - half, int(y) - half
    a, b = x - int(x), y - int(y)
    upper_left, upper_right = (1.0 - b) * (1.0 - a), (1.0 - b) * a
    lower_left, lower_right = b * (1.0 - a), b * a
    # unsigned places, which need no check
    side, width, right = np.uint64(2 * half + 1), np.uint64(w), np.uint64(1)
    pixels, first = grey.ravel(), np.uint64(top * w + left)
    for j in range(side):
        here, line = first + j * width, j * side
        below = here + width
        for i in range(side):
            out[line + i] = (
                upper_left * pixels[here + i]
                + upper_right * pixels[here + i + right]
                + lower_left * pixels[below + i]
                + lower_right * pixels[below + i + right]
            )
    return True


@njit(cache=True, nogil=True)
def _centred(patch: Array) -> float:
    """Take its mean from a patch (S,); its length then."""
    total = 0.0
    for k in range(patch.shape[0]):
        total += patch[k]
    total /= patch.shape[0]
    squares = 0.0
    for k in range(patch.shape[0]):
        patch[k] -= total
        squares += patch[k] * patch[k]
    length: float = np.sqrt(squares)
    return length


@njit(cache=True, nogil=True)
def _compared(mine: Array, its: Array, products: Array, lengths: Array) -> None:
    """Products (4,) of a centred patch (S,) with others (4,S), each less its mean, and lengths (4,) of those."""
    n = mine.shape[0]
    one, two, three, four = its[0], its[1], its[2], its[3]
    a = b = c = d = 0.0
    for i in range(n):
        a += one[i]
        b += two[i]
        c += three[i]
        d += four[i]
    a, b, c, d = a / n, b / n, c / n, d / n
    a2 = b2 = c2 = d2 = 0.0
    ma = mb = mc = md = 0.0
    for i in range(n):
        m = mine[i]
        u, v, w, z = one[i] - a, two[i] - b, three[i] - c, four[i] - d
        a2 += u * u
        b2 += v * v
        c2 += w * w
        d2 += z * z
        ma += m * u
        mb += m * v
        mc += m * w
        md += m * z
    products[0], products[1], products[2], products[3] = ma, mb, mc, md
    lengths[0], lengths[1], lengths[2], lengths[3] = (
        np.sqrt(a2),
        np.sqrt(b2),
        np.sqrt(c2),
        np.sqrt(d2),
    )


@njit(cache=True, nogil=True)
def match_along_rays(
    grey: NDArray[np.uint8],
    other: NDArray[np.uint8],
    at_px: Array,
    there_px: Array,
    half: int,
    least_contrast: float,
    apart: int,
    least_ahead: float,
    place: Array,
    alike: Array,
) -> None:
    """Where along each ray the pictures agree best, by zero-mean normalised cross-correlation of patches.

    grey, other (h,w); at_px (N,2): the rays' pixels in the first; there_px (N,K,2): where K places along each ray show
    in the other, NaN for none. Fills place (N,), 0..K-1 between places, and alike (N,), the correlation there; alike
    is -1 where the patch has less contrast (standard deviation, grey values), the best place is at an end, or it is
    not ahead by least_ahead of all places that are `apart` or more from it.
    """
    size = (2 * half + 1) ** 2
    mine, its = np.empty(size), np.zeros((_TOGETHER, size))
    products, lengths = np.empty(_TOGETHER), np.empty(_TOGETHER)
    within = np.empty(_TOGETHER, np.bool_)
    n_places = there_px.shape[1]
    scores = np.empty(n_places)
    for n in range(at_px.shape[0]):
        place[n], alike[n] = 0.0, -1.0
        if not _patch(grey, at_px[n, 0], at_px[n, 1], half, mine):
            continue
        length = _centred(mine)
        if length < least_contrast * np.sqrt(float(size)):
            continue
        best = 0
        for first in range(0, n_places, _TOGETHER):
            together = min(_TOGETHER, n_places - first)
            for c in range(together):
                x, y = there_px[n, first + c, 0], there_px[n, first + c, 1]
                within[c] = _patch(other, x, y, half, its[c])
            _compared(mine, its, products, lengths)
            for c in range(together):
                k = first + c
                scores[k] = -1.0
                if within[c] and lengths[c] > 0.0:
                    scores[k] = products[c] / (length * lengths[c])
                if scores[k] > scores[best]:
                    best = k
        if best == 0 or best == n_places - 1:
            continue
        rival = -1.0
        for k in range(n_places):
            if abs(k - best) >= apart:
                rival = max(rival, scores[k])
        if rival > scores[best] - least_ahead:
            continue
        bend = scores[best - 1] - 2.0 * scores[best] + scores[best + 1]
        beside = 0.5 * (scores[best - 1] - scores[best + 1]) / bend if bend < -1e-6 else 0.0
        place[n], alike[n] = best + min(max(beside, -0.5), 0.5), scores[best]
