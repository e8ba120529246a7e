"""sRGB and linear light."""

import numpy as np
from numpy.typing import ArrayLike

from mocapd.types import Floats


def linear_from_srgb(srgb: ArrayLike) -> Floats:
    """sRGB values 0..255 of any shape to linear 0..1 (IEC 61966-2-1)."""
    v = np.asarray(srgb, dtype=float) / 255.0
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)
