"""How far along a ray something is: a patch of one picture looked for in another, along the ray's image there."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.types import Bytes

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Weights = tuple[np.float32, np.float32, np.float32, np.float32]

# of a row of a patch: wider than any patch, and a whole number of the processor's vectors
_LANES = 16
_LEAST_SHARE = 0.3  # of a patch that is of one surface
_FLAT = np.float32(0.03)  # length of a patch less its mean; what has less is of one grey


class PatchLabels(NamedTuple):
    """Surfaces in a picture: label (h,w) of blocks of block_px pixels each way, beginning at block `left`, `top`; 0:
    unknown. The texture of a surface shows its distance; its outline lies farther, where it curves away. (0,0): whole patches
    are compared."""

    label: Bytes
    left: int
    top: int
    block_px: int


@kernel
def _place(shape: tuple[int, int], x: float, y: float, half: int) -> tuple[int, Weights]:
    """Where in a picture's pixels, all in one row, the patch about x, y begins, -1 where it leaves the picture; and the
    weights of the four pixels, two here and two below, that each of its own lies between."""
    h, w = shape
    a, b = np.float32(x - np.floor(x)), np.float32(y - np.floor(y))
    one = np.float32(1.0)
    weights = ((one - b) * (one - a), (one - b) * a, b * (one - a), b * a)
    if not (x >= half and y >= half and x < w - 1 - half and y < h - 1 - half):
        return -1, weights
    first = (int(y) - half) * w + int(x) - half
    # whole lanes are read
    return (first if first + (2 * half + 1) * w + _LANES < h * w else -1), weights


@kernel(fastmath=True, error_model="numpy", inline="always")
def _grey_at(
    pixels: NDArray[np.uint8], here: np.uint64, below: np.uint64, weights: Weights
) -> np.float32:
    """Between four pixels, of which two are `here` and right of it, two below."""
    right = np.uint64(1)
    return (
        weights[0] * np.float32(pixels[here])
        + weights[1] * np.float32(pixels[here + right])
        + weights[2] * np.float32(pixels[below])
        + weights[3] * np.float32(pixels[below + right])
    )


@kernel(fastmath=True, error_model="numpy")
def _centred(
    pixels: NDArray[np.uint8],
    width: int,
    first: int,
    weights: Weights,
    within: Singles,
    count: np.float32,
    out: Singles,
) -> np.float32:
    """Fill out (side,_LANES) with the patch that begins `first` in the pixels of a picture, so many a row, less its mean; its
    length then. within (side,_LANES): 1 for a pixel of the patch that counts, else 0; so many count."""
    side, step = out.shape[0], np.uint64(width)
    total, squares = np.float32(0.0), np.float32(0.0)
    for j in range(side):
        here, row, counts = np.uint64(first) + np.uint64(j) * step, out[j], within[j]
        for i in range(np.uint64(_LANES)):
            row[i] = counts[i] * _grey_at(pixels, here + i, here + step + i, weights)
            total += row[i]
    mean = total / count
    for j in range(side):
        row, counts = out[j], within[j]
        for i in range(np.uint64(_LANES)):
            row[i] -= mean * counts[i]
            squares += row[i] * row[i]
    length: np.float32 = np.sqrt(squares)
    return length


@kernel(fastmath=True, error_model="numpy")
def _correlation(
    mine: Singles,
    pixels: NDArray[np.uint8],
    width: int,
    first: int,
    weights: Weights,
    within: Singles,
    count: np.float32,
) -> np.float32:
    """Of a centred patch (side,_LANES) of length 1 with that which begins `first` in the pixels of another picture; -1 with
    one that is flat. The rest is as in `_centred`."""
    side, step = mine.shape[0], np.uint64(width)
    total, squares, products = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    for j in range(side):
        here, row, counts = np.uint64(first) + np.uint64(j) * step, mine[j], within[j]
        for i in range(np.uint64(_LANES)):
            its = _grey_at(pixels, here + i, here + step + i, weights)
            inside = its * counts[i]
            total += inside
            squares += inside * its
            products += row[i] * its
    squares -= total * total / count
    if squares < _FLAT * _FLAT:
        return np.float32(-1.0)
    alike: np.float32 = products / np.sqrt(squares)
    return alike


@kernel
def match_along_rays(
    grey: NDArray[np.uint8],
    other: NDArray[np.uint8],
    at_px: Array,
    there_px: Array,
    half: int,
    least_contrast: float,
    apart: int,
    least_ahead: float,
    surfaces: PatchLabels,
    place: Array,
    alike: Array,
) -> None:
    """Where along each ray the pictures agree best, by zero-mean normalised cross-correlation of patches.

    grey, other (h,w); at_px (N,2): the rays' pixels in the first; there_px (N,K,2): where K places along each ray show
    in the other, NaN for none; half: at most 7. Fills place (N,), 0..K-1 between places, and alike (N,), the correlation
    there; alike is -1 where the patch has less contrast (standard deviation, grey values), the best place is at an end,
    or it is not ahead by least_ahead of all places that are `apart` or more from it. Only those pixels of a patch count that
    have the label of its middle, see `PatchLabels`.
    """
    side = 2 * half + 1
    mine, within = np.zeros((side, _LANES), np.float32), np.zeros((side, _LANES), np.float32)
    within[:, :side] = 1.0
    count = np.float32(side * side)
    labels, left, top, block_px = surfaces
    rows, columns = labels.shape
    own, its = grey.ravel(), other.ravel()
    n_places = there_px.shape[1]
    scores = np.empty(n_places)
    for n in range(at_px.shape[0]):
        place[n], alike[n] = 0.0, -1.0
        first, weights = _place(grey.shape, at_px[n, 0], at_px[n, 1], half)
        if first < 0:
            continue
        if rows > 0:
            x0, y0 = int(at_px[n, 0]), int(at_px[n, 1])
            label = labels[y0 // block_px - top, x0 // block_px - left]
            count = np.float32(0.0)
            for j in range(side):
                row = min(max((y0 - half + j) // block_px - top, 0), rows - 1)
                for i in range(side):
                    column = min(max((x0 - half + i) // block_px - left, 0), columns - 1)
                    within[j, i] = np.float32(labels[row, column] == label)
                    count += within[j, i]
            if label == 0 or count < _LEAST_SHARE * side * side:
                continue
        length = _centred(own, grey.shape[1], first, weights, within, count, mine)
        if length < _FLAT or length < least_contrast * np.sqrt(count):
            continue
        mine /= length
        best = 0
        for k in range(n_places):
            first, weights = _place(other.shape, there_px[n, k, 0], there_px[n, k, 1], half)
            scores[k] = -1.0
            if first >= 0:
                scores[k] = _correlation(mine, its, other.shape[1], first, weights, within, count)
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


EVERYWHERE = PatchLabels(np.zeros((0, 0), np.uint8), 0, 0, 1)
