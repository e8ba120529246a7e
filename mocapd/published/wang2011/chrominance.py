"""Histogram search: where the picture is as colourful as the shirt (paper §4)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.published.wang2011.histogram_kernels import (
    BINS,
    DIVISIONS,
    NO_BIN,
    integral_histogram,
    uniformity,
)
from mocapd.types import Bytes, Floats, Singles


@dataclass(frozen=True, slots=True)
class HistogramParams:
    """The paper's constants. `step_px`: every sixth pixel; `radii`: six window sizes, each
    2 radius + 1 samples a side (54, 78, 114, 162, 246 and 366 px); `bin_cap`: tau;
    `deviation`: u_sigma / u_max; `min_sum`: darker pixels (r+g+b of bytes) count as grey.
    """

    step_px: int = 6
    radii: tuple[int, ...] = (4, 6, 9, 13, 20, 30)
    bin_cap: float = 0.1
    deviation: float = 0.1
    min_sum: int = 48


@dataclass(frozen=True, slots=True)
class Colourful:
    """The weighted mean window: centre x_px, y_px and side s_px; u_max in 0..1, the best window's u."""

    x_px: float
    y_px: float
    s_px: float
    u_max: float


def histogram_search(
    pixels: Bytes, mask: Bytes, mask_shift: int, params: HistogramParams
) -> Colourful:
    """The colourful place of `pixels` (H,W,3) uint8 BGR.

    `mask`: foreground hint, non-zero where to look, 2^mask_shift times smaller than the frame.
    """
    step = params.step_px
    height, width = pixels.shape[0] // step, pixels.shape[1] // step
    integral = np.empty((height + 1, width + 1, BINS), dtype=np.uint16)
    radii: NDArray[np.int64] = np.array(params.radii, dtype=np.int64)
    u: Singles = np.empty((len(radii), height, width), dtype=np.float32)
    bins = chrominance_bins(pixels, mask, mask_shift, step, params.min_sum)
    integral_histogram(bins, integral)
    uniformity(integral, radii, params.bin_cap, u)
    return weighted_mean(u, radii, step, params.deviation)


def chrominance_bins(pixels: Bytes, mask: Bytes, shift: int, step: int, min_sum: int) -> Bytes:
    """(gh,gw): the chrominance bin 0..99 of every `step`-th pixel, NO_BIN for background.

    The chrominances (r,g,b)/(r+g+b) fill a triangle; ten divisions of each side cut it into exactly a hundred equal
    triangles. The sample (i,j) is the pixel at the middle of its cell. Pixels darker than r+g+b = min_sum have no
    chrominance to speak of and count as grey.
    """
    rows, columns = (np.arange(n // step) * step + step // 2 for n in pixels.shape[:2])
    sampled = pixels[step // 2 :: step, step // 2 :: step][: len(rows), : len(columns)].astype(
        np.int16
    )
    total = sampled.sum(axis=2)
    sampled[total < min_sum] = 1
    cells = DIVISIONS * sampled // sampled.sum(axis=2, keepdims=True, dtype=np.int16)
    # barycentric cell: red row, green column, and which of the cell's two triangles
    red = np.minimum(cells[..., 2], DIVISIONS - 1)
    green = np.minimum(cells[..., 1], DIVISIONS - 1 - red)
    upside_down = red + green + cells[..., 0] < DIVISIONS - 1
    # row `red` holds 2 (10 - red) - 1 triangles; rows above it hold the rest
    bins = red * (2 * DIVISIONS - red) + 2 * green + upside_down
    return np.where(mask[np.ix_(rows >> shift, columns >> shift)] == 0, NO_BIN, bins).astype(
        np.uint8
    )


def weighted_mean(
    u: Singles, radii: NDArray[np.int64], step_px: int, deviation: float
) -> Colourful:
    """The mean of (x, y, s) weighted by exp(-(u - u_max)^2 / u_sigma^2), u_sigma = deviation u_max.

    u (S,gh,gw). The centre of the frame with u_max 0 when nothing is foreground.
    """
    u_max = float(u.max())
    if u_max > 0.0:
        weights: Floats = np.exp(-(((u - u_max) / (deviation * u_max)) ** 2))
    else:
        weights = np.ones(u.shape)
    total = weights.sum()
    per_scale = weights.sum(axis=(1, 2))
    per_row = weights.sum(axis=(0, 2))
    per_column = weights.sum(axis=(0, 1))
    half = step_px // 2
    return Colourful(
        x_px=float(per_column @ np.arange(u.shape[2]) / total) * step_px + half,
        y_px=float(per_row @ np.arange(u.shape[1]) / total) * step_px + half,
        s_px=float(per_scale @ (2 * radii + 1) / total) * step_px,
        u_max=u_max,
    )
