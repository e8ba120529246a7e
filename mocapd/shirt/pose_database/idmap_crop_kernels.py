"""Cutting an id map of any size down to the 40x40 map that the pose database is asked with.

The one crop of both the database and the queries: a square about the middle of the box of the coloured
pixels, 1.15 times the box's longer side. For the box a pixel counts if at least three of its four
neighbours are coloured too, and the outermost 1 % on each of the four sides are left out, so that
misclassified specks far away do not shrink the body. A cell
of the map takes the colour that most of its coloured pixels have (of equals the lower id), if at least
half of its pixels are coloured; a cell smaller than a pixel takes the pixel it lies in.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Bytes = NDArray[np.uint8]

SIZE = 40
MARGIN = 1.15
TRIM = 0.01
N_IDS = 11  # nothing and ten colours


@kernel
def trimmed_span(counts: NDArray[np.int64], total: int) -> tuple[int, int]:
    """First and last index of `counts` (n,) that keep all but TRIM of `total` on each side."""
    allowed = total * TRIM
    first, last = 0, counts.shape[0] - 1
    seen = counts[first]
    while first < last and seen <= allowed:
        first += 1
        seen += counts[first]
    seen = counts[last]
    while last > first and seen <= allowed:
        last -= 1
        seen += counts[last]
    return first, last


@kernel
def crop_window(ids: Bytes) -> tuple[float, float, float]:
    """Centre x, y [px, pixel centres at integers] and side [px] of the square; side 0: nothing is coloured."""
    h, w = ids.shape
    columns, rows = np.zeros(w, np.int64), np.zeros(h, np.int64)
    total = 0
    for y in range(1, h - 1):
        above, row, below = ids[y - 1], ids[y], ids[y + 1]
        for x in range(1, w - 1):
            if row[x] == 0:
                continue
            beside = (above[x] != 0) + (below[x] != 0) + (row[x - 1] != 0) + (row[x + 1] != 0)
            if beside >= 3:
                columns[x] += 1
                rows[y] += 1
                total += 1
    if total == 0:
        return 0.5 * (w - 1), 0.5 * (h - 1), 0.0
    x0, x1 = trimmed_span(columns, total)
    y0, y1 = trimmed_span(rows, total)
    return 0.5 * (x0 + x1), 0.5 * (y0 + y1), MARGIN * max(x1 - x0 + 1, y1 - y0 + 1)


@kernel
def resample(ids: Bytes, cx: float, cy: float, side: float, out: Bytes) -> None:
    """The square of this centre and side [px] as cells of out (SIZE,SIZE); outside of `ids` is nothing."""
    h, w = ids.shape
    scale = side / SIZE
    left, top = cx - 0.5 * side + 0.5, cy - 0.5 * side + 0.5  # pixel i covers [i, i + 1)
    votes = np.zeros(256, np.int64)
    for v in range(SIZE):
        # the pixels whose centres lie in the cell's rows
        y0 = int(np.ceil(top + v * scale - 0.5))
        y1 = int(np.ceil(top + (v + 1) * scale - 0.5)) - 1
        if y1 < y0:
            y0 = y1 = int(np.floor(top + (v + 0.5) * scale))
        for u in range(SIZE):
            x0 = int(np.ceil(left + u * scale - 0.5))
            x1 = int(np.ceil(left + (u + 1) * scale - 0.5)) - 1
            if x1 < x0:
                x0 = x1 = int(np.floor(left + (u + 0.5) * scale))
            coloured, best, most = 0, 0, 0
            for y in range(max(y0, 0), min(y1, h - 1) + 1):
                for x in range(max(x0, 0), min(x1, w - 1) + 1):
                    c = ids[y, x]
                    if c != 0:
                        coloured += 1
                        votes[c] += 1
                        if votes[c] > most or (votes[c] == most and c < best):
                            best, most = int(c), votes[c]
            out[v, u] = best if 2 * coloured >= (y1 - y0 + 1) * (x1 - x0 + 1) else 0
            if coloured > 0:
                for y in range(max(y0, 0), min(y1, h - 1) + 1):
                    for x in range(max(x0, 0), min(x1, w - 1) + 1):
                        votes[ids[y, x]] = 0


def crop_id_map(ids: Bytes) -> tuple[Bytes, float, tuple[float, float]]:
    """The 40x40 id map of a colour id map (h,w), its scale and its centre.

    scale: pixels of `ids` per cell, 0 when nothing is coloured; centre: x, y [px]. Cell (u, v) lies at
    x = centre_x + (u - 19.5) * scale, y = centre_y + (v - 19.5) * scale.
    """
    cx, cy, side = crop_window(ids)
    out = np.zeros((SIZE, SIZE), np.uint8)
    if side > 0.0:
        resample(ids, cx, cy, side, out)
    return out, side / SIZE, (cx, cy)


@kernel
def pack(ids: Bytes, out: Bytes) -> None:
    """Two ids to a byte: (SIZE,SIZE) into (SIZE*SIZE/2,)."""
    flat = ids.reshape(-1)
    for i in range(out.shape[0]):
        out[i] = flat[2 * i] | (flat[2 * i + 1] << 4)


@kernel
def unpack(packed: Bytes, out: Bytes) -> None:
    """The inverse of `pack`."""
    flat = out.reshape(-1)
    for i in range(packed.shape[0]):
        flat[2 * i] = packed[i] & 15
        flat[2 * i + 1] = packed[i] >> 4
