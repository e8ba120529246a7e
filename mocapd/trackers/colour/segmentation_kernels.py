"""From work pictures to colour ids: static background, pose-assisted classification, colour statistics."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
FAR = 255  # distance [half work px] of a colour that is nowhere near


@njit(cache=True, nogil=True)
def learn_background(
    picture: NDArray[np.uint8],
    body: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    rate: float,
    phase: int,
    step: int,
) -> None:
    """Follow each pixel's colour where `body` (h,w) is 0. mean (h,w,3) 0..255; age (h,w) counts looks.

    Only rows y with y % step == phase are visited: the background changes slowly.
    """
    h, w, _ = picture.shape
    for y in range(phase, h, step):
        for x in range(w):
            if body[y, x] != 0:
                continue
            a = age[y, x]
            f = np.float32(max(rate, 1.0 / (a + 1.0)))
            for c in range(3):
                mean[y, x, c] += f * (np.float32(picture[y, x, c]) - mean[y, x, c])
            if a < 255:
                age[y, x] = a + 1


@njit(cache=True, nogil=True, inline="always")
def bin_of(bgr: NDArray[np.uint8]) -> int:
    """The bin of a colour: 5 bits a channel."""
    return (int(bgr[0]) >> 3) << 10 | (int(bgr[1]) >> 3) << 5 | int(bgr[2]) >> 3


@njit(cache=True, nogil=True)
def count_colours(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    body: NDArray[np.uint8],
    model_ids: NDArray[np.uint8],
    image_ids: NDArray[np.uint8],
    softness: NDArray[np.uint8],
    shirt_count: NDArray[np.float32],
    other_count: NDArray[np.float32],
) -> None:
    """Count colours seen on the shirt, and on moving things outside of `body` (H,W), the widened shirt."""
    h, w = model_ids.shape
    for y in range(0, h, 2):
        for x in range(0, w, 2):
            k = model_ids[y, x]
            if k > 0:
                if image_ids[y, x] == k:
                    shirt_count[bin_of(picture[y0 + y, x0 + x])] += 1.0
            elif softness[y, x] != 255 and body[y0 + y, x0 + x] == 0:
                other_count[bin_of(picture[y0 + y, x0 + x])] += 1.0


@njit(cache=True, nogil=True)
def classify(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    distance: NDArray[np.uint8],
    affine: NDArray[np.float32],
    prior: float,
    threshold: float,
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    tolerance: float,
    background_penalty: float,
    shirt_count: NDArray[np.float32],
    other_count: NDArray[np.float32],
    other_penalty: float,
    soft_unclassified: float,
    soft_unknown: float,
    ids: NDArray[np.uint8],
    softness: NDArray[np.uint8],
) -> None:
    """Pose-assisted classification (paper section 5.2, step 3) of the region at x0, y0.

    picture (H,W,3) BGR; ids and softness (h,w) are filled. distance (h2,w2,10): half work px from
    each coarse pixel to the predicted region of each colour; prior: standard deviations per work px.
    affine (10,3,4): whitened distance of colour k is |A (b,g,r,1)|. A pixel that looks like the
    static background pays `background_penalty`; one whose colour is rather seen on other things
    than on the shirt pays up to `other_penalty` (counts per colour bin). softness: how firmly an unclassified pixel denies
    the shirt, 255 where background is seen, and out of reach of every colour.
    """
    h, w = ids.shape
    h2, w2, _ = distance.shape
    sure, soft, unknown = (
        np.uint8(255),
        np.uint8(255 * soft_unclassified),
        np.uint8(255 * soft_unknown),
    )
    tol = np.float32(tolerance * 255.0)
    step = np.float32(2.0 * prior)
    top = np.float32(threshold)
    behind = np.float32(background_penalty)
    elsewhere = np.float32(other_penalty)
    near = np.empty(10, np.int64)
    price = np.empty(10, np.float32)
    for cy in range(h2):
        for cx in range(w2):
            n = 0
            for k in range(10):
                d = distance[cy, cx, k]
                if d != FAR and step * d < top:
                    near[n] = k
                    price[n] = step * d
                    n += 1
            for y in range(2 * cy, min(2 * cy + 2, h)):
                for x in range(2 * cx, min(2 * cx + 2, w)):
                    if n == 0:
                        ids[y, x] = 0
                        softness[y, x] = sure
                        continue
                    v, u = y0 + y, x0 + x
                    b = np.float32(picture[v, u, 0])
                    g = np.float32(picture[v, u, 1])
                    r = np.float32(picture[v, u, 2])
                    known = age[v, u] >= 6
                    still = (
                        known
                        and abs(b - mean[v, u, 0]) < tol
                        and abs(g - mean[v, u, 1]) < tol
                        and abs(r - mean[v, u, 2]) < tol
                    )
                    softness[y, x] = sure if still else (soft if known else unknown)
                    # the penalties are the same for every colour, so they lower the threshold and
                    # cannot change the winner
                    limit = top - behind if still else top
                    best = limit
                    best_k = 0
                    for i in range(n):
                        k = near[i]
                        base = price[i]
                        room = best - base
                        if room <= 0.0:
                            continue
                        room2 = room * room
                        z = (
                            affine[k, 0, 0] * b
                            + affine[k, 0, 1] * g
                            + affine[k, 0, 2] * r
                            + affine[k, 0, 3]
                        )
                        s = z * z
                        if s >= room2:
                            continue
                        z = (
                            affine[k, 1, 0] * b
                            + affine[k, 1, 1] * g
                            + affine[k, 1, 2] * r
                            + affine[k, 1, 3]
                        )
                        s += z * z
                        if s >= room2:
                            continue
                        z = (
                            affine[k, 2, 0] * b
                            + affine[k, 2, 1] * g
                            + affine[k, 2, 2] * r
                            + affine[k, 2, 3]
                        )
                        s += z * z
                        if s < room2:
                            best = base + np.sqrt(s)
                            best_k = k + 1
                    if best_k > 0:
                        bin_ = bin_of(picture[v, u])
                        other = other_count[bin_]
                        best += elsewhere * other / (other + shirt_count[bin_] + np.float32(8.0))
                        if best >= limit:
                            best_k = 0
                    ids[y, x] = best_k


@njit(cache=True, nogil=True)
def colour_distances(
    ids: NDArray[np.uint8], limit: int, divisor: NDArray[np.int64], out: NDArray[np.uint8]
) -> None:
    """City-block-chamfer distance (3-4) of each coarse pixel to each colour; out (h2,w2,10), FAR beyond limit.

    ids (h,w) is read at every second pixel; distances are in coarse pixels, each colour's divided by
    its `divisor` (10,): a colour whose place is in doubt is looked for farther away.
    """
    h2, w2, _ = out.shape
    buffer = np.empty((h2, w2), np.int32)
    box = np.empty((10, 4), np.int64)  # of each colour: first and last column, first and last row
    for k in range(10):
        box[k, 0], box[k, 1], box[k, 2], box[k, 3] = w2, -1, h2, -1
    for y in range(h2):
        for x in range(w2):
            k = ids[2 * y, 2 * x]
            if k > 0:
                box[k - 1, 0] = min(box[k - 1, 0], x)
                box[k - 1, 1] = max(box[k - 1, 1], x)
                box[k - 1, 2] = min(box[k - 1, 2], y)
                box[k - 1, 3] = y
    out[:] = FAR
    nearest = limit
    for k in range(10):
        limit = nearest * divisor[k]
        big = 3 * limit + 1
        if box[k, 1] < 0:
            continue
        x_lo, x_hi = max(0, box[k, 0] - limit), min(w2 - 1, box[k, 1] + limit)
        y_lo, y_hi = max(0, box[k, 2] - limit), min(h2 - 1, box[k, 3] + limit)
        for y in range(y_lo, y_hi + 1):
            for x in range(x_lo, x_hi + 1):
                buffer[y, x] = 0 if ids[2 * y, 2 * x] == k + 1 else big
        for y in range(y_lo, y_hi + 1):
            for x in range(x_lo, x_hi + 1):
                v = buffer[y, x]
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
                    out[y, x, k] = v // (3 * divisor[k])


@njit(cache=True, nogil=True)
def colour_statistics(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    model_ids: NDArray[np.uint8],
    image_ids: NDArray[np.uint8],
    only_classified: bool,
    sums: Array,
) -> None:
    """Add up the colours inside the rendered patches: sums (10,4) = n, b, g, r [0..1].

    A pixel counts when it and its four neighbours were rendered with one colour, and, when
    `only_classified`, the picture was classified so too.
    """
    h, w = model_ids.shape
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            k = model_ids[y, x]
            if k == 0:
                continue
            if only_classified and image_ids[y, x] != k:
                continue
            if (
                model_ids[y - 1, x] != k
                or model_ids[y + 1, x] != k
                or model_ids[y, x - 1] != k
                or model_ids[y, x + 1] != k
            ):
                continue
            b = picture[y0 + y, x0 + x, 0] / 255.0
            g = picture[y0 + y, x0 + x, 1] / 255.0
            r = picture[y0 + y, x0 + x, 2] / 255.0
            s = sums[k - 1]
            s[0] += 1.0
            s[1] += b
            s[2] += g
            s[3] += r


@njit(cache=True, nogil=True)
def agreement(model_ids: NDArray[np.uint8], image_ids: NDArray[np.uint8]) -> tuple[int, int]:
    """How many rendered pixels there are, and at how many the picture was given the same colour."""
    h, w = model_ids.shape
    n = same = 0
    for y in range(h):
        for x in range(w):
            if model_ids[y, x] > 0:
                n += 1
                if image_ids[y, x] == model_ids[y, x]:
                    same += 1
    return n, same


@njit(cache=True, nogil=True)
def changed(
    picture: NDArray[np.uint8],
    body: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    tolerance: float,
) -> float:
    """Share of the known background, body left out, that no longer looks as learned, from every 24th pixel."""
    h, w, _ = picture.shape
    n = different = 0
    tol = np.float32(tolerance * 255.0)
    for y in range(0, h, 6):
        for x in range(0, w, 4):
            if body[y, x] != 0 or age[y, x] < 6:
                continue
            n += 1
            for c in range(3):
                if abs(np.float32(picture[y, x, c]) - mean[y, x, c]) > tol:
                    different += 1
                    break
    return different / max(n, 1)


@njit(cache=True, nogil=True)
def snap_background(
    picture: NDArray[np.uint8],
    body: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
) -> None:
    """Take the picture for the background where `body` (h,w) is 0, and forget what was behind the body.

    With nobody known anything is forgotten: somebody unseen may stand in the picture.
    """
    h, w, _ = picture.shape
    nobody = not body.any()
    for y in range(h):
        for x in range(w):
            if nobody or body[y, x] != 0:
                age[y, x] = 0
                continue
            for c in range(3):
                mean[y, x, c] = picture[y, x, c]
