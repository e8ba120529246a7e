"""What the classified picture says of the colours: statistics, counts, agreement with the pose;
which pixels look like bare skin; and where in a whole picture the many colours of the shirt are together.

The last one is the paper's uniformity on ids: section 4 finds the shirt where the histogram of chrominance is most even.
Asked of ten classes instead of a hundred chrominances, the same measure ignores furniture that is colourful in other colours.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.shirt.segmentation.cell_kernels import bin_of

Array = NDArray[np.float64]
CELL = 4  # work px
CAP = 0.05  # share of a window at which a colour counts in full


@kernel
def count_colours(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    body: NDArray[np.uint8],
    model_ids: NDArray[np.uint8],
    image_ids: NDArray[np.uint8],
    pixel_weight: NDArray[np.uint8],
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
            elif pixel_weight[y, x] != 255 and body[y0 + y, x0 + x] == 0:
                other_count[bin_of(picture[y0 + y, x0 + x])] += 1.0


@kernel
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


@kernel
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


@kernel
def suppress_background(
    picture: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    tolerance: float,
    ids: NDArray[np.uint8],
) -> None:
    """Set ids (h,w) to 0 where the picture looks like the known background."""
    h, w = ids.shape
    tol = tolerance * 255.0
    for y in range(h):
        for x in range(w):
            if ids[y, x] == 0 or age[y, x] < 6:
                continue
            m, p = mean[y, x], picture[y, x]
            if abs(p[0] - m[0]) < tol and abs(p[1] - m[1]) < tol and abs(p[2] - m[2]) < tol:
                ids[y, x] = 0


@kernel
def find_shirt(
    ids: NDArray[np.uint8], sizes: NDArray[np.int64]
) -> tuple[int, int, int, int, float]:
    """The window x0, y0, x1, y1 [px] with the most even colours, and its evenness 0..1.

    sizes: window sides in cells of CELL px. Evenness: sum over colours of min(share, CAP), over 10 CAP.
    """
    h, w = ids.shape
    gh, gw = h // CELL, w // CELL
    total = np.zeros((gh + 1, gw + 1, 10), np.int32)
    row = np.zeros(10, np.int32)
    for gy in range(gh):
        for k in range(10):
            row[k] = 0
        for gx in range(gw):
            for y in range(gy * CELL, (gy + 1) * CELL):
                for x in range(gx * CELL, (gx + 1) * CELL):
                    k = ids[y, x]
                    if k > 0:
                        row[k - 1] += 1
            for k in range(10):
                total[gy + 1, gx + 1, k] = total[gy, gx + 1, k] + row[k]
    best = -1.0
    bx = by = bs = 0
    for n in range(sizes.shape[0]):
        s = sizes[n]
        if s > gh or s > gw:
            continue
        limit = CAP * (s * CELL) ** 2
        step = max(1, s // 6)
        for gy in range(0, gh - s + 1, step):
            for gx in range(0, gw - s + 1, step):
                u = 0.0
                for k in range(10):
                    c = (
                        total[gy + s, gx + s, k]
                        - total[gy, gx + s, k]
                        - total[gy + s, gx, k]
                        + total[gy, gx, k]
                    )
                    u += min(float(c), limit)
                u /= limit * 10.0
                if u > best:
                    best, bx, by, bs = u, gx, gy, s
    return bx * CELL, by * CELL, (bx + bs) * CELL, (by + bs) * CELL, best
