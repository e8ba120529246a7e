"""Histogram search: where the picture is as colourful as the shirt (paper §4)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.published.wang2011.histogram_kernels import (
    BINS,
    chrominance_bins,
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


class HistogramSearch:
    """Buffers for frames of one size, without state between frames. One thread."""

    def __init__(self, size_px: tuple[int, int], params: HistogramParams) -> None:
        self.params = params
        step = self.params.step_px
        width, height = size_px[0] // step, size_px[1] // step
        self._bins = np.empty((height, width), dtype=np.uint8)
        self._integral = np.empty((height + 1, width + 1, BINS), dtype=np.uint16)
        self._radii: NDArray[np.int64] = np.array(self.params.radii, dtype=np.int64)
        self._u: Singles = np.empty((len(self._radii), height, width), dtype=np.float32)

    def search(self, pixels: Bytes, mask: Bytes, mask_shift: int) -> Colourful:
        """The colourful place of `pixels` (H,W,3) uint8 BGR.

        `mask`: foreground hint, non-zero where to look, 2^mask_shift times smaller than the frame.
        """
        params = self.params
        chrominance_bins(pixels, mask, mask_shift, params.step_px, params.min_sum, self._bins)
        integral_histogram(self._bins, self._integral)
        uniformity(self._integral, self._radii, params.bin_cap, self._u)
        return weighted_mean(self._u, self._radii, params.step_px, params.deviation)


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
