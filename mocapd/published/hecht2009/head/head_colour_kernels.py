"""Colours of a head and of what is around it: their bins, and counts as log odds."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

SIDE = 16  # bins of blue, green and red

Singles = NDArray[np.float32]


@kernel(inline="always")
def colour_bin(b: int, g: int, r: int, gain: float) -> int:
    """Of a colour whose brightness is scaled by gain."""
    i = min(int(b * gain) >> 4, SIDE - 1)
    j = min(int(g * gain) >> 4, SIDE - 1)
    k = min(int(r * gain) >> 4, SIDE - 1)
    return (i * SIDE + j) * SIDE + k


@kernel
def log_odds(mine: Singles, others: Singles, floor: float, out: Singles) -> None:
    """Fill out (B,) with the log odds of each bin, from counts (B,), squeezed into -1..1.

    floor: share of all counts that an empty bin is taken to have.
    """
    n = len(mine)
    total_mine, total_others = max(mine.sum(), 1.0), max(others.sum(), 1.0)
    for i in range(n):
        a = mine[i] / total_mine + floor / n
        b = others[i] / total_others + floor / n
        out[i] = np.float32(np.tanh(0.5 * np.log(a / b)))
