"""Pose-assisted classification (paper section 5.2, step 3) in cells of 4 x 4 work pixels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.vision.raster_kernels import triangle_middle

CELL = 4  # px: all pixels of a cell share the distances to the predicted colours
FAR = 255  # distance of a colour that is nowhere near
_LANES = CELL * CELL


class LearnedPixels(NamedTuple):
    """The static background, mean (H,W,3) BGR 0..255 and how often it was seen (H,W), and how often
    each colour bin was seen on the shirt and on other things (32768,)."""

    mean: NDArray[np.float32]
    age: NDArray[np.uint8]
    shirt_count: NDArray[np.float32]
    other_count: NDArray[np.float32]


class ClassifierWeights(NamedTuple):
    """prior: standard deviations per work px away from a colour's place; threshold [standard
    deviations]. tolerance: largest channel difference to the background, 0..1; a pixel that looks
    like it pays background_penalty, one whose colour is rather seen on other things than on the
    shirt up to other_penalty; skin must be nearer than a colour by skin_penalty. soft_unclassified,
    soft_unknown: pixel_weight 0..1 of an unclassified pixel before a background that is known and that is not."""

    prior: float
    threshold: float
    tolerance: float
    background_penalty: float
    other_penalty: float
    skin_penalty: float
    soft_unclassified: float
    soft_unknown: float


@kernel(inline="always")
def bin_of(bgr: NDArray[np.uint8]) -> int:
    """The bin of a colour: 5 bits a channel."""
    return (int(bgr[0]) >> 3) << 10 | (int(bgr[1]) >> 3) << 5 | int(bgr[2]) >> 3


@kernel
def colour_distances(
    ids: NDArray[np.uint8],
    xy: NDArray[np.float64],
    triangles: NDArray[np.int32],
    sleeves: NDArray[np.int64],
    colour: NDArray[np.uint8],
    limit: int,
    divisor: NDArray[np.int64],
    out: NDArray[np.uint8],
) -> None:
    """City-block-chamfer distance (3-4) of each cell to each colour; out (h4,w4,10) [work px], FAR beyond limit.

    A cell holds a colour when one of its pixels of `ids` (h,w) at even places does, or when the
    middle of one of the triangles `sleeves` (S,) is there, seen or hidden: an arm may come out from
    behind the body. xy (V,2) px of the vertices; colour (T,) of the triangles. Each colour's
    distance is divided by its `divisor` (10,): a colour whose place is uncertain is looked for
    farther away. limit [cells].
    """
    h, w = ids.shape
    h4, w4, _ = out.shape
    held = np.zeros((h4, w4), np.int32)
    box = np.empty((10, 4), np.int64)  # of each colour: first and last column, first and last row
    for k in range(10):
        box[k, 0], box[k, 1], box[k, 2], box[k, 3] = w4, -1, h4, -1
    for y in range(0, h, 2):
        for x in range(0, w, 2):
            if ids[y, x] > 0:
                held[y // CELL, x // CELL] |= np.int32(1) << (ids[y, x] - 1)
    for t in sleeves:
        middle_x, middle_y = triangle_middle(xy, triangles, t)
        x, y = round(middle_x), round(middle_y)
        if 0 <= x < w and 0 <= y < h:
            held[y // CELL, x // CELL] |= np.int32(1) << (colour[t] - 1)
    for y in range(h4):
        for x in range(w4):
            for k in range(10):
                out[y, x, k] = FAR
                if held[y, x] >> k & 1:
                    box[k, 0] = min(box[k, 0], x)
                    box[k, 1] = max(box[k, 1], x)
                    box[k, 2] = min(box[k, 2], y)
                    box[k, 3] = y
    buffer = np.empty((h4, w4), np.int32)
    for k in range(10):
        if box[k, 1] < 0:
            continue
        reach = limit * divisor[k]
        big = 3 * reach + 1
        x_lo, x_hi = max(0, box[k, 0] - reach), min(w4 - 1, box[k, 1] + reach)
        y_lo, y_hi = max(0, box[k, 2] - reach), min(h4 - 1, box[k, 3] + reach)
        for y in range(y_lo, y_hi + 1):
            for x in range(x_lo, x_hi + 1):
                v = 0 if held[y, x] >> k & 1 else big
                if x > x_lo:
                    v = min(v, buffer[y, x - 1] + 3)
                if y > y_lo:
                    v = min(v, buffer[y - 1, x] + 3)
                    if x > x_lo:
                        v = min(v, buffer[y - 1, x - 1] + 4)
                    if x < x_hi:
                        v = min(v, buffer[y - 1, x + 1] + 4)
                buffer[y, x] = v
        for y in range(y_hi, y_lo - 1, -1):
            for x in range(x_hi, x_lo - 1, -1):
                v = buffer[y, x]
                if x < x_hi:
                    v = min(v, buffer[y, x + 1] + 3)
                if y < y_hi:
                    v = min(v, buffer[y + 1, x] + 3)
                    if x < x_hi:
                        v = min(v, buffer[y + 1, x + 1] + 4)
                    if x > x_lo:
                        v = min(v, buffer[y + 1, x - 1] + 4)
                buffer[y, x] = v
                if v < big:
                    out[y, x, k] = min(CELL * v // (3 * divisor[k]), FAR - 1)


@kernel(fastmath=True)
def classify(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    distance: NDArray[np.uint8],
    affine: NDArray[np.float32],
    skin: NDArray[np.float32],
    learned: LearnedPixels,
    weights: ClassifierWeights,
    ids: NDArray[np.uint8],
    pixel_weight: NDArray[np.uint8],
) -> None:
    """Fill ids and pixel_weight (h,w) of the region at x0, y0 of picture (H,W,3) BGR.

    distance (h4,w4,10): of `colour_distances`. affine (10,3,4): whitened distance of colour k is
    |A (b,g,r,1)|; skin (3,4): of bare skin, which is none of them. pixel_weight: how firmly an unclassified
    pixel denies the shirt, 255 where background is seen, and out of reach of every colour. What looks like the shirt and
    like its background may be either: it is unclassified, and denies the shirt softly.
    """
    mean, age, shirt_count, other_count = learned
    h, w = ids.shape
    h4, w4, _ = distance.shape
    sure = np.uint8(255)
    prior, threshold, tolerance, behind_, elsewhere_, barer_, soft_, unknown_ = weights
    soft, unknown = np.uint8(255 * soft_), np.uint8(255 * unknown_)
    tol = np.float32(tolerance * 255.0)
    step = np.float32(prior)
    top = np.float32(threshold)
    behind = np.float32(behind_)
    elsewhere = np.float32(elsewhere_)
    barer = np.float32(barer_)
    # a cell's pixels side by side, so that the compiler makes vector instructions of the loops
    b, g, r = (
        np.empty(_LANES, np.float32),
        np.empty(_LANES, np.float32),
        np.empty(_LANES, np.float32),
    )
    limit, best = np.empty(_LANES, np.float32), np.empty(_LANES, np.float32)
    winner = np.empty(_LANES, np.int32)
    for cy in range(h4):
        rows = min(CELL, h - CELL * cy)
        for cx in range(w4):
            columns = min(CELL, w - CELL * cx)
            reachable = False
            for k in range(10):
                d = distance[cy, cx, k]
                reachable |= (d != FAR) & (step * d < top)
            if not reachable:
                for y in range(CELL * cy, CELL * cy + rows):
                    for x in range(CELL * cx, CELL * cx + columns):
                        ids[y, x] = 0
                        pixel_weight[y, x] = sure
                continue
            for i in range(rows):
                v = y0 + CELL * cy + i
                for j in range(columns):
                    u = x0 + CELL * cx + j
                    n = CELL * i + j
                    b[n] = picture[v, u, 0]
                    g[n] = picture[v, u, 1]
                    r[n] = picture[v, u, 2]
                    known = age[v, u] >= 6
                    still = (
                        known
                        & (abs(b[n] - mean[v, u, 0]) < tol)
                        & (abs(g[n] - mean[v, u, 1]) < tol)
                        & (abs(r[n] - mean[v, u, 2]) < tol)
                    )
                    pixel_weight[CELL * cy + i, CELL * cx + j] = (
                        sure if still else (soft if known else unknown)
                    )
                    # the penalties are the same for every colour, so they lower the threshold and
                    # cannot change the winner
                    limit[n] = top - behind if still else top
            for n in range(_LANES):
                best[n] = top
                winner[n] = 0
            for k in range(10):
                d = distance[cy, cx, k]
                if d == FAR or step * d >= top:
                    continue
                price = step * d
                a = affine[k]
                for n in range(_LANES):
                    p = a[0, 0] * b[n] + a[0, 1] * g[n] + a[0, 2] * r[n] + a[0, 3]
                    q = a[1, 0] * b[n] + a[1, 1] * g[n] + a[1, 2] * r[n] + a[1, 3]
                    s = a[2, 0] * b[n] + a[2, 1] * g[n] + a[2, 2] * r[n] + a[2, 3]
                    cost = price + np.sqrt(p * p + q * q + s * s)
                    closer = cost < best[n]
                    best[n] = cost if closer else best[n]
                    winner[n] = k + 1 if closer else winner[n]
            for i in range(rows):
                for j in range(columns):
                    n = CELL * i + j
                    y, x = CELL * cy + i, CELL * cx + j
                    k = winner[n]
                    if k > 0:
                        bin_ = bin_of(picture[y0 + y, x0 + x])
                        other = other_count[bin_]
                        cost = best[n] + elsewhere * other / (
                            other + shirt_count[bin_] + np.float32(8.0)
                        )
                        p = skin[0, 0] * b[n] + skin[0, 1] * g[n] + skin[0, 2] * r[n] + skin[0, 3]
                        q = skin[1, 0] * b[n] + skin[1, 1] * g[n] + skin[1, 2] * r[n] + skin[1, 3]
                        s = skin[2, 0] * b[n] + skin[2, 1] * g[n] + skin[2, 2] * r[n] + skin[2, 3]
                        bare = np.sqrt(p * p + q * q + s * s)
                        if cost >= limit[n] or bare + barer < best[n]:
                            k = 0
                        elif limit[n] < top:  # its background looks like that, too
                            k = 0
                            pixel_weight[y, x] = soft
                    ids[y, x] = k
