"""What a webcam's lens is like before it is measured."""

from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.reprojection import LENS
from mocapd.types import Floats


@dataclass(frozen=True, slots=True)
class LensPriors:
    """Standard deviations. What the pictures tell outweighs them; what they do not tell stays sane.

    Pixels are square, the axis meets the picture near its middle, and distortion is moderate.
    """

    aspect: float = 0.005  # of fx / fy from 1
    middle: float = 0.025  # of cx, cy from the middle, in picture widths
    dist: tuple[float, float, float, float, float] = (0.3, 0.3, 0.003, 0.003, 0.2)

    def residuals(self, lens: Floats, size_px: Floats) -> Floats:
        """(C,8), in standard deviations; lens (C,9), size_px (C,2)."""
        aspect = np.log(lens[:, 0] / lens[:, 1]) / self.aspect
        middle = (lens[:, 2:4] - 0.5 * (size_px - 1.0)) / (self.middle * size_px[:, :1])
        return np.column_stack([aspect, middle, lens[:, 4:] / np.array(self.dist)])

    def slope(self, lens: Floats, size_px: Floats) -> Floats:
        """d residuals by lens, (C,8,9)."""
        out = np.zeros((len(lens), 8, LENS))
        out[:, 0, 0] = 1.0 / (self.aspect * lens[:, 0])
        out[:, 0, 1] = -1.0 / (self.aspect * lens[:, 1])
        out[:, 1, 2] = out[:, 2, 3] = 1.0 / (self.middle * size_px[:, 0])
        out[:, np.arange(3, 8), np.arange(4, 9)] = 1.0 / np.array(self.dist)
        return out
