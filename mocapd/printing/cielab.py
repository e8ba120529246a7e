"""CIELAB of sRGB colours, as printers and dyers name them."""

import numpy as np
from numpy.typing import ArrayLike

from mocapd.sim.colour import linear_from_srgb
from mocapd.types import Floats

# XYZ from linear sRGB, white D65 (IEC 61966-2-1)
_XYZ_FROM_RGB = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)
# Rows sum to the white point of that matrix, (0.9505, 1.0000, 1.0890): equal RGB is then exactly grey.
D65_WHITE = _XYZ_FROM_RGB.sum(axis=1)
_DELTA = 6 / 29


def lab_from_srgb(srgb: ArrayLike) -> Floats:
    """sRGB 0..255 (...,3) to CIE 1976 L* 0..100, a*, b* (...,3), relative to D65 (2 degrees).

    CIE 15:2004, equations 8.3 to 8.8. The white is that of sRGB itself and is not adapted: readers
    that want Lab of D50 (ICC profiles, many spectrophotometers) adapt it.
    """
    xyz = linear_from_srgb(srgb) @ _XYZ_FROM_RGB.T / D65_WHITE
    f = np.where(xyz > _DELTA**3, np.cbrt(xyz), xyz / (3 * _DELTA**2) + 4 / 29)
    x, y, z = f[..., 0], f[..., 1], f[..., 2]
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)
