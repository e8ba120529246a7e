"""Colour classification through a table over 32 x 32 x 32 cells of the image's own colours.

A table belongs to one colour model and one white balance. Only the cells inside the ten ellipsoids
are visited, so a new table costs less than classifying a small region exactly. Conventions of
`pixels_bgr`, `mask`, `mask_shift`, x0, y0, `stride` and `out` as in `classify_kernels`.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

UInt8 = NDArray[np.uint8]
Float32 = NDArray[np.float32]

CELLS = 32
TABLE_SIZE = CELLS**3  # index: red cell << 10 | green cell << 5 | blue cell


@kernel
def build_tables(
    upper: Float32,
    offset: Float32,
    threshold: float,
    ids: UInt8,
) -> None:
    """Fill a table from the maps of `colour_model.fold`.

    ids (TABLE_SIZE,): the nearest colour's id 1..10 where it is within `threshold`, else 0. A cell
    counts as the colour at its centre.
    """
    ids[:] = 0
    reach2 = np.float32(threshold * threshold)
    limit = np.float32(threshold)
    best = np.full(TABLE_SIZE, limit, dtype=np.float32)
    for k in range(upper.shape[0]):
        u00 = upper[k, 0, 0]
        for red in range(CELLS):
            r = np.float32(8.0 * red + 3.5)
            z2 = upper[k, 2, 2] * r + offset[k, 2]
            left2 = reach2 - z2 * z2
            if left2 < 0.0:
                continue
            for green in range(CELLS):
                g = np.float32(8.0 * green + 3.5)
                z1 = upper[k, 1, 1] * g + upper[k, 1, 2] * r + offset[k, 1]
                left1 = left2 - z1 * z1
                if left1 < 0.0:
                    continue
                # |u00 b + rest| <= sqrt(left1): an interval of blue
                rest = upper[k, 0, 1] * g + upper[k, 0, 2] * r + offset[k, 0]
                middle = -rest / u00
                half = np.sqrt(left1) / abs(u00)
                first = max(0, int(np.ceil((middle - half - 3.5) / 8.0)))
                last = min(CELLS - 1, int(np.floor((middle + half - 3.5) / 8.0)))
                for blue in range(first, last + 1):
                    z0 = u00 * np.float32(8.0 * blue + 3.5) + rest
                    distance = np.sqrt(z0 * z0 + reach2 - left1)
                    cell = (red << 10) | (green << 5) | blue
                    if distance < best[cell]:
                        best[cell] = distance
                        ids[cell] = k + 1


@kernel(inline="always")
def _cell(row: UInt8, x: int) -> np.uint32:
    """The cell of pixel x of a row (W,3) BGR."""
    red = np.uint32(row[x, 2] >> 3) << np.uint32(10)
    green = np.uint32(row[x, 1] >> 3) << np.uint32(5)
    return red | green | np.uint32(row[x, 0] >> 3)


@kernel
def classify_by_table(
    pixels_bgr: UInt8,
    mask: UInt8,
    mask_shift: int,
    table_ids: UInt8,
    x0: int,
    y0: int,
    stride: int,
    out: UInt8,
) -> tuple[int, int]:
    """Step 1: out (h,w) ids 0..10. Returns the counts of classified and of foreground samples."""
    classified = 0
    foreground = 0
    for i in range(out.shape[0]):
        row = pixels_bgr[y0 + stride * i]
        mask_row = mask[(y0 + stride * i) >> mask_shift]
        ids = out[i]
        # two plain loops: the compiler turns the second into vector instructions
        for j in range(ids.shape[0]):
            ids[j] = table_ids[_cell(row, x0 + stride * j)]
        for j in range(ids.shape[0]):
            seen = mask_row[(x0 + stride * j) >> mask_shift] != 0
            ids[j] = ids[j] if seen else np.uint8(0)
            foreground += seen
            classified += ids[j] > 0
    return classified, foreground
