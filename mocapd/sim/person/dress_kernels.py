"""The colour of a point of a dressed person, as a function of its place in the T-pose (a solid texture)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.sim.person.face_kernels import add_face
from mocapd.types import Bytes, Floats

# by which rule a triangle is coloured; FLAT: by its own colour
FLAT, FACE, TRUNK, SLEEVE, LEG = 0, 1, 2, 3, 4
PLAIN, STRIPES, CHECKS, PRINT = 0, 1, 2, 3
# columns of `outfits`: the joint of the neck, the stature as the head has it, the height of a print, how far from the
# middle sleeves and a jacket's sleeves end [m], then of each cloth its two linear colours, pattern and period [m]
NECK_Y, NECK_Z, SIZE, CHEST, SLEEVE_END, REACH, CLOTHS = 0, 1, 2, 3, 4, 5, 6
_SECOND, _PATTERN, _PERIOD, _PER_CLOTH = 3, 6, 7, 8
SKIN, HAIR, TOP, TROUSERS, JACKET = (CLOTHS + _PER_CLOTH * i for i in range(5))
_RIM_M = 0.025  # how far inside of its edge a jacket has its full thickness
_ZIP_M = 0.006


class Dress(NamedTuple):
    """What T triangles on V vertices of N people wear.

    rest_m (V,3): where the cloth is in the T-pose, without folds; rule (T,); under_jacket (T,): as what part of
    one it may be covered, FLAT, TRUNK or SLEEVE; person (T,); outfits (N,46), one array, as the kernels count
    references for each that they hand on.
    """

    rest_m: Floats
    rule: Bytes
    under_jacket: Bytes
    person: NDArray[np.int32]
    outfits: Floats


def jacket_share(x_m: Floats, reach_m: float, level: float) -> Floats:
    """How much of a jacket's thickness there is (V,) 0..1 at places x_m (V,) to the left of the middle."""
    inside = np.clip(covered(x_m, reach_m, level) / _RIM_M, 0.0, 1.0)
    share: Floats = inside * inside * (3.0 - 2.0 * inside)
    return share


@kernel
def covered(x: Floats | float, reach_m: float, level: float) -> Floats | float:
    """How far [m] a place x to the left of the middle lies inside of the edge of a jacket at this level 0..1."""
    return level * (2.0 * reach_m + 2.0 * _RIM_M) - _RIM_M - (x + reach_m)


@kernel
def _woven(
    of: Floats, n: int, cloth: int | np.int64, along: float, across: float, rgb: Floats
) -> None:
    """The cloth's colour where the stripes run across `along` [m]."""
    pattern, period = of[n, cloth + _PATTERN], of[n, cloth + _PERIOD]
    share = 0.0
    if pattern == STRIPES:
        share = 1.0 if along / period - np.floor(along / period) < 0.5 else 0.0
    elif pattern == CHECKS:
        share = 0.5 if along / period - np.floor(along / period) < 0.4 else 0.0
        share += 0.5 if across / period - np.floor(across / period) < 0.4 else 0.0
    for c in range(3):
        rgb[c] = (1.0 - share) * of[n, cloth + c] + share * of[n, cloth + _SECOND + c]


@kernel
def _printed(of: Floats, n: int, x: float, y: float, z: float) -> bool:
    """A ring and a bar on the chest, two bars on the back."""
    size = of[n, SIZE]
    u, v = x / size, (y - of[n, CHEST]) / size
    if z > of[n, NECK_Z]:
        r = np.sqrt(u * u + v * v)
        inside = 0.026 < r < 0.042 or r < 0.011 or (abs(v + 0.062) < 0.008 and abs(u) < 0.04)
    else:
        inside = (abs(v) < 0.012 or abs(v + 0.04) < 0.007) and abs(u) < 0.045
    return bool(inside)


@kernel
def _head(of: Floats, n: int, x: float, y: float, z: float, rgb: Floats) -> None:
    size = of[n, SIZE]
    u, v, w = x / size, (y - of[n, NECK_Y]) / size, (z - of[n, NECK_Z]) / size
    behind = min(w, 0.0)
    hairline = 0.113 - 0.35 * max(abs(u) - 0.022, 0.0)
    hair = v > 0.112 - 0.45 * behind or (v > 0.045 and w < -0.005) or (v > hairline and w < 0.075)
    hair = hair or (v > 0.075 and w < 0.022)
    row = HAIR if hair else SKIN
    for c in range(3):
        rgb[c] = of[n, row + c]
    if hair:
        return
    ear = ((w - 0.004) / 0.009) ** 2 + ((v - 0.072) / 0.016) ** 2
    if abs(u) > 0.036 and ear < 1.0:
        for c in range(3):
            rgb[c] *= 0.72 if ear > 0.4 else 0.85
    if w > 0.012:
        add_face(u, v, of[n, HAIR : HAIR + 3], rgb)
    if v < 0.033:  # under the chin
        for c in range(3):
            rgb[c] *= 0.78


@kernel
def surface_colour(
    x: float,
    y: float,
    z: float,
    rule: int,
    under_jacket: int,
    n: int,
    level: float,
    of: Floats,
    rgb: Floats,
) -> None:
    """Turns a triangle's own colour, linear rgb (3,), in place, into that of its point (x, y, z) [m] in the
    T-pose. of (N,46): the outfits, n: whose; level: of the jacket, 0 off, 1 on."""
    neck = (x * x + (y - of[n, NECK_Y]) ** 2 + (z - of[n, NECK_Z]) ** 2) / of[n, SIZE] ** 2
    collar = neck < 0.030**2 and z > of[n, NECK_Z]
    if under_jacket != FLAT and not collar and covered(x, of[n, REACH], level) > 0.0:
        if under_jacket == SLEEVE:
            _woven(of, n, np.int64(JACKET), abs(x), z, rgb)
        else:
            _woven(of, n, np.int64(JACKET), y, x, rgb)
        if under_jacket == TRUNK and abs(x) < _ZIP_M and z > of[n, NECK_Z]:
            for c in range(3):
                rgb[c] = 0.02 + 0.2 * rgb[c]
        return
    if rule == FACE:
        _head(of, n, x, y, z, rgb)
    elif rule == TRUNK:
        _woven(of, n, np.int64(TOP), y, x, rgb)
        if of[n, TOP + _PATTERN] == PRINT and _printed(of, n, x, y, z):
            for c in range(3):
                rgb[c] = of[n, TOP + _SECOND + c]
        if neck < 0.047**2:
            for c in range(3):
                rgb[c] = of[n, SKIN + c]
    elif rule == SLEEVE:
        _woven(of, n, np.int64(TOP), abs(x), z, rgb)
        if abs(x) > of[n, SLEEVE_END]:
            for c in range(3):
                rgb[c] = of[n, SKIN + c]
    elif rule == LEG:
        _woven(of, n, np.int64(TROUSERS), x, y, rgb)
