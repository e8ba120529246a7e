"""What goes into the network of heatmaps, and the moments of what comes out."""

import math

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.types import Bytes, Floats, Singles

_STRONG = 4.0 / 255.0  # a difference of a quarter of the range is a sure one


@kernel
def fill_input(picture: Bytes, background: Singles, known: Bytes, out: Singles) -> None:
    """out (4,h,w): a picture (h,w,3) about its middle grey, and how far it is off a background (h,w,3), 0..1; 0 where that is
    not known (h,w)."""
    h, w = known.shape
    for y in range(h):
        for x in range(w):
            most = np.float32(0.0)
            for k in range(3):
                value = np.float32(picture[y, x, k])
                out[k, y, x] = value / np.float32(255.0) - np.float32(0.5)
                most = max(most, abs(value - background[y, x, k]))
            out[3, y, x] = min(most * np.float32(_STRONG), np.float32(1.0)) if known[y, x] else 0.0


@kernel
def read_maps(maps: NDArray[np.float32], joints: int, out: Floats) -> None:
    """out (J,7) of maps (3 J,h,w), whose first J are log odds of places: mean x, y [cells] and variances xx, xy, yy of the
    distribution that their softmax is, and what the others say there: depth, and the scale of its error."""
    h, w = maps.shape[1:]
    for j in range(joints):
        highest = -np.inf
        for y in range(h):
            for x in range(w):
                highest = max(highest, maps[j, y, x])
        total = mx = my = xx = xy = yy = depth = scale = 0.0
        for y in range(h):
            for x in range(w):
                p = math.exp(maps[j, y, x] - highest)
                total += p
                mx += p * x
                my += p * y
                xx += p * x * x
                xy += p * x * y
                yy += p * y * y
                depth += p * maps[joints + j, y, x]
                scale += p * maps[2 * joints + j, y, x]
        mx, my = mx / total, my / total
        out[j, 0], out[j, 1] = mx, my
        out[j, 2] = xx / total - mx * mx
        out[j, 3] = xy / total - mx * my
        out[j, 4] = yy / total - my * my
        out[j, 5] = depth / total
        out[j, 6] = math.exp(min(max(scale / total, -4.0), 1.0))
