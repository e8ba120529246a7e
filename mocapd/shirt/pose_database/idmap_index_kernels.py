"""Compiled parts of the index over id maps: a vector for each, whose Euclidean distance follows the map distance (blurred
colour planes), and the distances of these."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.shirt.pose_database.idmap_crop_kernels import N_IDS, SIZE

Singles = NDArray[np.float32]
Ints = NDArray[np.int64]
Bytes = NDArray[np.uint8]
BLOCK = 4  # [px] cells of the coarse planes
COARSE = SIZE // BLOCK
LENGTH = (N_IDS - 1) * COARSE * COARSE


@kernel(fastmath=True)
def squared_gap(a: Singles, b: Singles) -> np.float32:
    """Squared Euclidean distance of two vectors."""
    total = np.float32(0.0)
    for i in range(a.shape[0]):
        d = a[i] - b[i]
        total += d * d
    return total


@kernel
def scan_cells(
    query: Singles, vectors: Singles, start: Ints, cells: Ints, index: Ints, gap: Singles
) -> int:
    """Squared distances of `query` (D,) to the vectors of some cells; returns how many were written."""
    n = 0
    for c in cells:
        for i in range(start[c], start[c + 1]):
            index[n] = i
            gap[n] = squared_gap(query, vectors[i])
            n += 1
    return n


@kernel
def describe_packed(maps: Bytes, out: Singles) -> None:
    """Raw descriptors out (N, LENGTH) of packed maps (N, SIZE*SIZE/2).

    Each colour's occupancy is summed in blocks of 4x4 cells, blurred by a 3x3 binomial (so that a shift
    of a few cells changes little), and its square root taken, which weighs small patches up.
    """
    raw = np.empty((N_IDS, COARSE, COARSE), np.float32)
    across = np.empty((COARSE, COARSE), np.float32)
    for n in range(maps.shape[0]):
        raw[:] = 0.0
        for i in range(maps.shape[1]):
            y = (2 * i) // SIZE
            x = 2 * i - y * SIZE
            low, high = maps[n, i] & 15, maps[n, i] >> 4
            raw[low, y // BLOCK, x // BLOCK] += 1.0
            raw[high, y // BLOCK, (x + 1) // BLOCK] += 1.0
        for c in range(1, N_IDS):
            plane = raw[c]
            for y in range(COARSE):
                for x in range(COARSE):
                    left = plane[y, x - 1] if x > 0 else np.float32(0.0)
                    right = plane[y, x + 1] if x < COARSE - 1 else np.float32(0.0)
                    across[y, x] = 0.25 * (left + right) + 0.5 * plane[y, x]
            base = (c - 1) * COARSE * COARSE
            for y in range(COARSE):
                for x in range(COARSE):
                    above = across[y - 1, x] if y > 0 else np.float32(0.0)
                    below = across[y + 1, x] if y < COARSE - 1 else np.float32(0.0)
                    out[n, base + y * COARSE + x] = np.sqrt(
                        0.25 * (above + below) + 0.5 * across[y, x]
                    )
