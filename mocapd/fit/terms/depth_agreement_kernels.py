"""Where the body as drawn is nearer or farther than what is seen there."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.vision.raster_kernels import NOTHING

_WELL_BEFORE = 2.0


@kernel
def compare_depths(
    drawn_m: NDArray[np.float32],
    triangle_at: NDArray[np.int32],
    area: NDArray[np.uint8],
    seen_m: NDArray[np.float32],
    grid_px: int,
    around_px: int,
    off_m: float,
    asked: NDArray[np.float64],
    off: NDArray[np.float64],
) -> tuple[float, float]:
    """Squared differences of all pixels, in those of off_m, at most 1 each, summed; and the pixels in which something is
    seen nearer by _WELL_BEFORE times off_m.

    drawn_m, seen_m (h,w): depths, NaN where none is seen; triangle_at (h,w): what is drawn; area (T,): of its triangles.
    seen_m is the same over squares of grid_px, in whose middle it was measured from what is within around_px: anything
    that is drawn there, or between, explains it, and so does the room where it shows and something farther is seen.
    Adds to asked (A,), by area, the pixels compared, and to off (A,) those that differ by more than off_m.
    """
    cost = nearer_px = 0.0
    h, w = seen_m.shape
    px = float(grid_px * grid_px)
    for y in range(grid_px // 2, h, grid_px):
        for x in range(grid_px // 2, w, grid_px):
            t = triangle_at[y, x]
            if t == NOTHING or np.isnan(seen_m[y, x]):
                continue
            seen = seen_m[y, x]
            nearest = farthest = drawn_m[y, x]
            for v in range(max(y - around_px, 0), min(y + around_px + 1, h)):
                for u in range(max(x - around_px, 0), min(x + around_px + 1, w)):
                    nearest = min(nearest, drawn_m[v, u])
                    farthest = max(farthest, drawn_m[v, u])
            away = max(nearest - seen, seen - farthest, 0.0) / off_m
            asked[area[t]] += px
            if away > 1.0:
                off[area[t]] += px
            cost += px * min(away * away, 1.0)
            if nearest - seen > _WELL_BEFORE * off_m:
                nearer_px += px
    return cost, nearer_px
