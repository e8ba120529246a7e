"""Where in a picture of colour ids the many colours of the shirt are together: the paper's uniformity on ids.

Section 4 finds the shirt where the histogram of chrominance is most even. Asked of ten classes
instead of a hundred chrominances, the same measure ignores furniture that is colourful in other colours.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

CELL = 4  # work px
CAP = 0.05  # share of a window at which a colour counts in full


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
