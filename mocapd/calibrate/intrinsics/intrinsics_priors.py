"""The prior of a webcam's intrinsics, before they are measured."""

from dataclasses import dataclass

import numpy as np

from mocapd.geometry.reprojection import INTRINSICS
from mocapd.types import Floats


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredIntrinsics:
    """Lenses (C,9) from an earlier measurement, and their standard deviations (C,9), infinite where unknown."""

    intrinsics: Floats
    deviation: Floats


@dataclass(frozen=True, slots=True, eq=False)
class IntrinsicsPriors:
    """Standard deviations. Measurements outweigh them; they bound what the pictures do not constrain.

    Pixels are square, the axis meets the picture near its middle, and distortion is moderate.
    `measured`: of cameras whose pictures of the board are not among the observations.
    """

    aspect: float = 0.005  # of fx / fy from 1
    middle: float = 0.025  # of cx, cy from the middle, in picture widths
    dist: tuple[float, float, float, float, float] = (0.3, 0.3, 0.003, 0.003, 0.2)
    measured: MeasuredIntrinsics | None = None

    def residuals(self, intrinsics: Floats, size_px: Floats) -> Floats:
        """(C,8), with measured intrinsics (C,17), in standard deviations; intrinsics (C,9), size_px (C,2)."""
        aspect = np.log(intrinsics[:, 0] / intrinsics[:, 1]) / self.aspect
        middle = (intrinsics[:, 2:4] - 0.5 * (size_px - 1.0)) / (self.middle * size_px[:, :1])
        parts = [aspect, middle, intrinsics[:, 4:] / np.array(self.dist)]
        if self.measured is not None:
            parts.append((intrinsics - self.measured.intrinsics) / self.measured.deviation)
        return np.column_stack(parts)

    def slope(self, intrinsics: Floats, size_px: Floats) -> Floats:
        """d residuals by intrinsics, (C,8,9) or (C,17,9)."""
        out = np.zeros((len(intrinsics), 8, INTRINSICS))
        out[:, 0, 0] = 1.0 / (self.aspect * intrinsics[:, 0])
        out[:, 0, 1] = -1.0 / (self.aspect * intrinsics[:, 1])
        out[:, 1, 2] = out[:, 2, 3] = 1.0 / (self.middle * size_px[:, 0])
        out[:, np.arange(3, 8), np.arange(4, 9)] = 1.0 / np.array(self.dist)
        if self.measured is None:
            return out
        measured = np.zeros((len(intrinsics), INTRINSICS, INTRINSICS))
        measured[:, np.arange(INTRINSICS), np.arange(INTRINSICS)] = 1.0 / self.measured.deviation
        return np.concatenate([out, measured], axis=1)
