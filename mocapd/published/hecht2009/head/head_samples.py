"""Sample points inside and along a head's outline, in shares of its half width and height."""

import numpy as np

from mocapd.types import Floats

_GOLDEN_RAD = np.pi * (3.0 - np.sqrt(5.0))
_NECK_RAD = 0.9  # either side of straight down, where the head has no edge


def _sunflower(n: int, radius: float) -> Floats:
    i = np.arange(n) + 0.5
    rho, phi = radius * np.sqrt(i / n), i * _GOLDEN_RAD
    return np.ascontiguousarray(np.column_stack([rho * np.cos(phi), rho * np.sin(phi)]))


def _arc(n: int) -> Floats:
    phi = np.linspace(-0.5 * np.pi + _NECK_RAD, 1.5 * np.pi - _NECK_RAD, n)
    return np.ascontiguousarray(np.column_stack([np.cos(phi), np.sin(phi)]))


INSIDE = _sunflower(36, 0.92)
OUTLINE = _arc(28)
