"""How far each pixel is from each region of the drawn body, all regions at once.

The two passes of the chamfer distance (Borgefors 1986), in OpenCV's weights. Vector instructions take the regions of a pixel
side by side, so that all take less than half of the time of a distance transform for each.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Singles = NDArray[np.float32]
LANES = 8  # places of a pixel, of which the regions 1.. take the first ones
_BESIDE_PX, _ACROSS_PX = 0.955, 1.3693
_FAR_PX = 1e3


@kernel
def chamfer_distances(drawn: NDArray[np.uint8], grid_px: float, out: Singles) -> None:
    """out (h+2,w+2,8): from each pixel of a grid of grid_px to where each of the regions is drawn (h,w) on it [px]; large
    where one is not, and in the border."""
    h, w = drawn.shape
    n = LANES * (w + 2)
    beside, across = np.float32(grid_px * _BESIDE_PX), np.float32(grid_px * _ACROSS_PX)
    rows = out.reshape(h + 2, n)
    rows[:] = np.float32(_FAR_PX)
    for y in range(h):
        row = rows[y + 1]
        _from_next_row(rows[y], row, beside, across)
        for x in range(w):
            k = drawn[y, x]
            if k > 0:
                row[LANES * (x + 1) + k - 1] = 0.0
        for i in range(LANES, n - LANES):
            row[i] = min(row[i], row[i - LANES] + beside)
    for y in range(h - 1, -1, -1):
        row = rows[y + 1]
        _from_next_row(rows[y + 2], row, beside, across)
        for i in range(n - LANES - 1, LANES - 1, -1):
            row[i] = min(row[i], row[i + LANES] + beside)


@kernel(inline="always")
def _from_next_row(other: Singles, row: Singles, beside: np.float32, across: np.float32) -> None:
    """Lessen a row (8 w,) by what is nearer by way of the row above or below. In slices, as with offsets in the index the
    compiler finds no vector instructions."""
    left, middle, right = other[: -2 * LANES], other[LANES:-LANES], other[2 * LANES :]
    mine = row[LANES:-LANES]
    for i in range(mine.shape[0]):
        nearest = min(left[i], right[i]) + across
        nearest = min(nearest, middle[i] + beside)
        mine[i] = min(mine[i], nearest)
