"""A face as colours on skin: brows, eyes, nose and mouth where adults have them.

Places are in statures, u to the person's left of the middle, v above the joint of the neck; the eyes lie
half-way between chin and crown, the nose's tip half-way from there to the chin.
"""

import numpy as np

from mocapd.kernels.decorator import kernel
from mocapd.types import Floats


@kernel
def _bump(x: float, y: float, wide: float, high: float) -> float:
    return float(np.exp(-((x / wide) ** 2) - (y / high) ** 2))


@kernel
def add_face(u: float, v: float, hair: Floats, rgb: Floats) -> None:
    """Turns skin rgb (3,), in place, into the face's colour at (u, v); hair (3,): of the brows."""
    a = abs(u)
    # light that sockets, the sides of the nose and its underside, lip and chin keep from each other
    shade = 1.0 - 0.30 * _bump(a - 0.0175, v - 0.0860, 0.0105, 0.0075)
    shade -= 0.22 * _bump(a - 0.0095, v - 0.0680, 0.0030, 0.0110)
    shade -= 0.40 * _bump(a, v - 0.0560, 0.0090, 0.0026)
    shade -= 0.22 * _bump(a, v - 0.0385, 0.0110, 0.0028)
    shade += 0.06 * _bump(a, v - 0.0700, 0.0040, 0.0120)
    red = _bump(a - 0.022, v - 0.060, 0.010, 0.009)
    for c in range(3):
        rgb[c] *= shade * (1.0 if c == 0 else 1.0 - 0.10 * red)
    lips = (a / 0.0155) ** 2 + ((v - 0.0465) / 0.0048) ** 2
    if lips < 1.0:
        line = 0.35 if abs(v - 0.0468 - 0.02 * a) < 0.0009 else 1.0
        for c in range(3):
            rgb[c] *= line * (0.72 if c == 0 else 0.42)
    if (a - 0.0045) ** 2 + (v - 0.0570) ** 2 < 0.0017**2:
        for c in range(3):
            rgb[c] *= 0.35
    arch = 0.0965 + 0.10 * (a - 0.008) - 7.0 * (a - 0.015) ** 2
    if 0.0075 < a < 0.0300 and abs(v - arch) < 0.0022:
        for c in range(3):
            rgb[c] = 0.25 * rgb[c] + 0.75 * hair[c]
    eye = ((a - 0.0178) / 0.0092) ** 2 + ((v - 0.0840) / 0.0042) ** 2
    if eye < 1.0:
        iris = (a - 0.0178) ** 2 + (v - 0.0840) ** 2 < 0.0038**2
        for c in range(3):
            rgb[c] = 0.035 if iris else 0.52
    elif eye < 1.7 and v > 0.0845:  # lashes
        for c in range(3):
            rgb[c] *= 0.30


@kernel
def portrait(u: float, v: float, rgb: Floats) -> None:
    """A picture of a head before the paper rgb (3,), in place; u, v in 0..1 over the sheet."""
    hair = np.array([0.05, 0.03, 0.02])
    x, y = 0.115 * (u - 0.5), 0.175 * v - 0.010
    skin = np.array([0.52, 0.30, 0.20])
    head = (x / 0.042) ** 2 + ((y - 0.082) / 0.055) ** 2 < 1.0
    neck = abs(x) < 0.020 and y < 0.05
    shoulders = y < 0.018 and abs(x) < 0.05
    if (x / 0.048) ** 2 + ((y - 0.090) / 0.058) ** 2 < 1.0 and y > 0.06:
        for c in range(3):
            rgb[c] = hair[c]
    if head or neck:
        for c in range(3):
            rgb[c] = skin[c] * (1.0 if head else 0.7)
        if head and y > 0.112 - 6.0 * x * x:
            for c in range(3):
                rgb[c] = hair[c]
        elif head:
            add_face(x, y, hair, rgb)
    elif shoulders:
        rgb[0], rgb[1], rgb[2] = 0.10, 0.12, 0.30
