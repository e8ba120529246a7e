"""Which body part hides a sample: quadrilaterals with depths, found through a grid of cells [Hecht et al. 2009, III.B]."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]

MOST_PARTS = 62  # a cell keeps its parts as bits


class OcclusionModel(NamedTuple):
    """C parts in one work picture.

    sides (C,4,3): a x + b y + c >= 0 inside of each side; slope (C,3): depth of the axis is a x + b y + c, held within
    near_far (C,2) [m], its least and greatest; cells (gh,gw): bit k is set where part k may cover the cell; cell_px.
    """

    sides: Array
    slope: Array
    near_far: Array
    cells: NDArray[np.int64]
    cell_px: float


@kernel(error_model="numpy")
def index_parts(quads: Array, depths: Array, model: OcclusionModel) -> None:
    """Fill a model of as many parts from quads (C,4,2) [work px] and depths (C,2) of both ends [m]. NaN quads hide
    nothing."""
    sides, slope, near_far, cells, cell_px = model
    gh, gw = cells.shape
    cells[:] = 0
    for c in range(quads.shape[0]):
        q = quads[c]
        area = 0.0
        for k in range(4):
            m = (k + 1) % 4
            area += q[k, 0] * q[m, 1] - q[m, 0] * q[k, 1]
        if not abs(area) >= 1.0:
            continue  # NaN, or nothing to see of it
        turn = 1.0 if area > 0.0 else -1.0
        for k in range(4):
            m = (k + 1) % 4
            dx, dy = turn * (q[m, 0] - q[k, 0]), turn * (q[m, 1] - q[k, 1])
            sides[c, k, 0], sides[c, k, 1] = -dy, dx
            sides[c, k, 2] = dy * q[k, 0] - dx * q[k, 1]
        near_far[c, 0], near_far[c, 1] = (
            min(depths[c, 0], depths[c, 1]),
            max(depths[c, 0], depths[c, 1]),
        )
        ax, ay = 0.5 * (q[0, 0] + q[3, 0]), 0.5 * (q[0, 1] + q[3, 1])
        dx, dy = 0.5 * (q[1, 0] + q[2, 0]) - ax, 0.5 * (q[1, 1] + q[2, 1]) - ay
        # shorter than a pixel it has no direction in the picture
        f = (depths[c, 1] - depths[c, 0]) / max(dx * dx + dy * dy, 1.0)
        slope[c, 0], slope[c, 1] = f * dx, f * dy
        slope[c, 2] = depths[c, 0] - f * (dx * ax + dy * ay)
        x0 = max(0, int(np.floor((q[:, 0].min() + 0.5) / cell_px)))
        x1 = min(gw - 1, int(np.floor((q[:, 0].max() + 0.5) / cell_px)))
        y0 = max(0, int(np.floor((q[:, 1].min() + 0.5) / cell_px)))
        y1 = min(gh - 1, int(np.floor((q[:, 1].max() + 0.5) / cell_px)))
        for y in range(y0, y1 + 1):
            for x in range(x0, x1 + 1):
                cells[y, x] |= np.int64(1) << c


@kernel(inline="always")
def is_hidden(
    model: OcclusionModel, others: int, x: float, y: float, depth: float, margin: float
) -> bool:
    """Whether one of the parts whose bits are set in `others` is nearer by more than `margin` [m] at the work pixel (x, y),
    which is inside of the picture. Axis is compared with axis."""
    sides, slope, near_far, cells, cell_px = model
    bits = cells[int((y + 0.5) / cell_px), int((x + 0.5) / cell_px)] & others
    c = 0
    while bits != 0:
        if bits & 1:
            limit = depth - margin
            if near_far[c, 0] < limit:
                inside = True
                for k in range(4):
                    if sides[c, k, 0] * x + sides[c, k, 1] * y + sides[c, k, 2] < 0.0:
                        inside = False
                        break
                if inside and (
                    near_far[c, 1] < limit
                    or slope[c, 0] * x + slope[c, 1] * y + slope[c, 2] < limit
                ):
                    return True
        bits >>= 1
        c += 1
    return False
