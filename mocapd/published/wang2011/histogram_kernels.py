"""Integral histograms of chrominance over a coarse grid (paper §4; integral histogram: [Por05])."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

UInt8 = NDArray[np.uint8]
UInt16 = NDArray[np.uint16]

DIVISIONS = 10  # of each side of the triangle of chrominances
BINS = DIVISIONS * DIVISIONS
NO_BIN = 255


@kernel
def integral_histogram(bins: UInt8, out: UInt16) -> None:
    """out (gh+1,gw+1,BINS): counts of each bin over the samples above and left of a corner."""
    out[0] = 0
    row = np.empty(BINS, dtype=np.uint16)
    for i in range(bins.shape[0]):
        out[i + 1, 0] = 0
        row[:] = 0
        for j in range(bins.shape[1]):
            k = bins[i, j]
            if k != NO_BIN:
                row[k] += 1
            above = out[i, j + 1]
            here = out[i + 1, j + 1]
            for n in range(BINS):
                here[n] = above[n] + row[n]


@kernel
def uniformity(
    integral: UInt16, radii: NDArray[np.int64], bin_cap: float, out: NDArray[np.float32]
) -> None:
    """out (S,gh,gw): u(h) = sum_i min(h_i, bin_cap) of the window of 2 radius + 1 samples a side.

    h is normalised by the whole window, so samples outside the image and background samples count
    as no colour at all: a few pixels in a corner must not look as colourful as a whole shirt.
    """
    gh, gw = out.shape[1], out.shape[2]
    for s in range(radii.shape[0]):
        radius = radii[s]
        area = float((2 * radius + 1) ** 2)
        cap = bin_cap * area
        whole = np.uint16(cap)
        fraction = cap - float(whole)
        for i in range(gh):
            top = integral[max(0, i - radius)]
            bottom = integral[min(gh, i + radius + 1)]
            for j in range(gw):
                left, right = max(0, j - radius), min(gw, j + radius + 1)
                a, b, c, d = top[left], top[right], bottom[left], bottom[right]
                # min(n, cap) of a whole number n is min(n, whole), plus the fraction once beyond;
                # 16-bit sums throughout, so that a vector instruction takes many bins at once
                capped = np.uint16(0)
                beyond = np.uint16(0)
                for k in range(BINS):
                    n = np.uint16(np.uint16(d[k] - c[k]) - np.uint16(b[k] - a[k]))
                    capped = np.uint16(capped + min(n, whole))
                    beyond = np.uint16(beyond + np.uint16(n > whole))
                out[s, i, j] = (float(capped) + fraction * float(beyond)) / area
