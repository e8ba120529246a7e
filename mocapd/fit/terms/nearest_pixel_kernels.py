"""Where the nearest pixel of a label is, and whether there can be one."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.vision.raster_kernels import triangle_middle

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
CELL = 8  # px of the grid that tells which labels are within reach


def offsets_by_distance(radius_px: int) -> NDArray[np.int32]:
    """Offsets (N,2) x, y within a radius, nearest first, without the centre."""
    r = np.arange(-radius_px, radius_px + 1)
    x, y = np.meshgrid(r, r)
    offsets = np.stack([x.ravel(), y.ravel()], axis=1)
    squared = (offsets**2).sum(axis=1)
    keep = (squared > 0) & (squared <= radius_px**2)
    order = np.lexsort((offsets[:, 0], offsets[:, 1], squared))
    inside: NDArray[np.int32] = offsets[order][keep[order]].astype(np.int32)
    return inside


@kernel(inline="always")
def nearest(
    ids: NDArray[np.uint8],
    x: int,
    y: int,
    k: int,
    offsets: NDArray[np.int32],
    n_offsets: int,
) -> int:
    """Index of the nearest offset at which ids == k, or -1."""
    h, w = ids.shape
    for i in range(n_offsets):
        u = x + offsets[i, 0]
        v = y + offsets[i, 1]
        if 0 <= u < w and 0 <= v < h and ids[v, u] == k:
            return i
    return -1


@kernel
def nearest_hidden(
    x: int,
    y: int,
    reach: float,
    xy: Array,
    triangles: NDArray[np.int32],
    arms: Ints,
    arms_start: Ints,
    k: int,
) -> int:
    """Place in `arms` of the triangle of label k whose middle is nearest, seen or not; or -1."""
    best, found = reach * reach, -1
    for s in range(arms_start[k], arms_start[k + 1]):
        t = arms[s]
        middle_x, middle_y = triangle_middle(xy, triangles, t)
        r2 = (x - middle_x) ** 2 + (y - middle_y) ** 2
        if r2 < best:
            best, found = r2, s
    return found


@kernel
def labels_in_reach(ids: NDArray[np.uint8], radius: float) -> NDArray[np.int32]:
    """Bit k of a cell of CELL px is set where label k may be within `radius` [px] of the cell: spares
    the search where it must fail. Bit 0 tells nothing."""
    h, w = ids.shape
    gh, gw = h // CELL + 1, w // CELL + 1
    own = np.zeros((gh, gw), np.int32)
    flat = ids.ravel()
    side = np.uint64(CELL)
    for y in range(h):
        cells = own[y // CELL]
        row = np.uint64(y * w)
        for gx in range(np.uint64(w // CELL)):
            # most hold nothing; of unsigned places, which need no check, all eight are loaded at once
            first = row + gx * side
            some = np.uint8(0)
            for i in range(side):
                some |= flat[first + i]
            if some == 0:
                continue
            bits = np.int32(0)
            for i in range(side):
                bits |= np.int32(1) << flat[first + i]
            cells[gx] |= bits
        for x in range(w // CELL * CELL, w):
            cells[gw - 1] |= np.int32(1) << ids[y, x]
    reach = int(np.ceil(radius / CELL))
    rows = np.zeros((gh, gw), np.int32)
    for gy in range(gh):
        for gx in range(gw):
            for o in range(max(0, gx - reach), min(gw, gx + reach + 1)):
                rows[gy, gx] |= own[gy, o]
    out = np.zeros((gh, gw), np.int32)
    for gy in range(gh):
        for o in range(max(0, gy - reach), min(gh, gy + reach + 1)):
            for gx in range(gw):
                out[gy, gx] |= rows[o, gx]
    return out
