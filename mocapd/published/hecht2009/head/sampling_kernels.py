"""Grey values between pixels."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel


@kernel(inline="always")
def grey_at(grey: NDArray[np.uint8], x: float, y: float) -> float:
    """Bilinear; negative outside the picture (h,w)."""
    h, w = grey.shape
    if not (0.0 <= x < w - 1.0 and 0.0 <= y < h - 1.0):
        return -1.0
    i, j = int(x), int(y)
    a, b = x - i, y - j
    top = (1.0 - a) * grey[j, i] + a * grey[j, i + 1]
    low = (1.0 - a) * grey[j + 1, i] + a * grey[j + 1, i + 1]
    value: float = (1.0 - b) * top + b * low
    return value
