"""A cascade of boosted multi-block LBP features, slid over an integral image."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

WINDOW_PX = 24  # side of the window that the cascade was trained on


class CascadeArrays(NamedTuple):
    """Stages S of weak classifiers T, which look at features.

    first (S+1,): where each stage's classifiers begin; threshold (S,); rects (T,4) x, y, width, height of the
    top left block of 3x3 [px of the window]; subsets (T,8): a bit for each LBP code; leaves (T,2): the vote of a code
    whose bit is set, and of another.
    """

    first: NDArray[np.int64]
    threshold: NDArray[np.float32]
    rects: NDArray[np.int64]
    subsets: NDArray[np.uint32]
    leaves: NDArray[np.float32]


@kernel(inline="always")
def lbp_code(integral: NDArray[np.int32], y: int, x: int, h: int, w: int) -> int:
    """The eight blocks around the middle one of 3x3 blocks (h,w), from the top left clockwise, as bits: not darker."""
    # the sixteen corners that the nine blocks share
    a, b, c, d = x, x + w, x + 2 * w, x + 3 * w
    top, second, third, low = integral[y], integral[y + h], integral[y + 2 * h], integral[y + 3 * h]
    a1, b1, c1, d1 = second[a], second[b], second[c], second[d]
    a2, b2, c2, d2 = third[a], third[b], third[c], third[d]
    middle = c2 - b2 - c1 + b1
    a0, b0, c0, d0 = top[a], top[b], top[c], top[d]
    a3, b3, c3, d3 = low[a], low[b], low[c], low[d]
    code = 0
    if b1 - a1 - b0 + a0 >= middle:
        code |= 128
    if c1 - b1 - c0 + b0 >= middle:
        code |= 64
    if d1 - c1 - d0 + c0 >= middle:
        code |= 32
    if d2 - c2 - d1 + c1 >= middle:
        code |= 16
    if d3 - c3 - d2 + c2 >= middle:
        code |= 8
    if c3 - b3 - c2 + b2 >= middle:
        code |= 4
    if b3 - a3 - b2 + a2 >= middle:
        code |= 2
    if b2 - a2 - b1 + a1 >= middle:
        code |= 1
    return code


@kernel
def stages_passed(cascade: CascadeArrays, integral: NDArray[np.int32], y: int, x: int) -> int:
    """Of the window whose corner is at y, x; as many as there are for a face."""
    n = len(cascade.threshold)
    for stage in range(n):
        votes = np.float32(0.0)
        for t in range(cascade.first[stage], cascade.first[stage + 1]):
            left, top, w, h = (
                cascade.rects[t, 0],
                cascade.rects[t, 1],
                cascade.rects[t, 2],
                cascade.rects[t, 3],
            )
            code = lbp_code(integral, y + top, x + left, h, w)
            if (cascade.subsets[t, code >> 5] >> np.uint32(code & 31)) & np.uint32(1):
                votes += cascade.leaves[t, 0]
            else:
                votes += cascade.leaves[t, 1]
        if votes < cascade.threshold[stage]:
            return stage
    return n


@kernel
def scan(
    cascade: CascadeArrays,
    integral: NDArray[np.int32],
    step: int,
    promising: int,
    out: NDArray[np.int64],
) -> int:
    """Windows that pass all stages: fill rows of out (n,2) with x, y of their corners; return how many.

    Of a grid with that step each window is looked at, and the others up to the next ones of the grid where one
    passes as many stages as `promising`.
    """
    height, width = integral.shape[0] - 1, integral.shape[1] - 1
    all_of_them = len(cascade.threshold)
    last_y, last_x = height - WINDOW_PX, width - WINDOW_PX
    n = 0
    for y in range(0, last_y + 1, step):
        for x in range(0, last_x + 1, step):
            first = stages_passed(cascade, integral, y, x)
            if first < min(promising, all_of_them):
                continue
            for j in range(y, min(y + step, last_y + 1)):
                for i in range(x, min(x + step, last_x + 1)):
                    passed = first if i == x and j == y else stages_passed(cascade, integral, j, i)
                    if passed == all_of_them and n < len(out):
                        out[n, 0], out[n, 1] = i, j
                        n += 1
    return n
