"""Hips are upright, more or less: before cameras that hardly see along their views nothing else says how a body leans."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]


@kernel
def set_upright(hips_xyzw: Array, information: float, H: Array, b: Array) -> None:
    """Add information [1/rad^2] of the rotation vector, in the world, by which the hips lean: of Y over to where they point
    up."""
    x, y, z, w = hips_xyzw[0], hips_xyzw[1], hips_xyzw[2], hips_xyzw[3]
    H[3, 3] += information
    H[5, 5] += information
    b[3] -= information * 2.0 * (y * z + w * x)
    b[5] += information * 2.0 * (x * y - w * z)
