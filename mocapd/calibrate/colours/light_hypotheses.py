"""White balances of plausible lights and camera corrections, to try before the light is estimated.

Each hypothesis is diagonal: the inverse of a light's colour, channel by channel (von Kries). Lights are
black bodies (lamps, sun and sky lie near their locus) and the same with the green or magenta tint of
discharge lamps and LEDs; a camera's partial correction of its light moves along the same locus.
"""

import numpy as np

from mocapd.types import Bytes, Floats

# reciprocal megakelvin: the eye's and a camera's steps are even in it; 2,400 K to 12,500 K
MIREDS = (80, 120, 155, 190, 230, 275, 330, 415)
# distance from the locus in CIE 1960 uv, ANSI C78.377 allows +-0.006, bare tubes go to twice that
TINTS_UV = (0.0, 0.012, -0.012)
LEVELS = (1.0, 1.35)  # of brightness, between the gains that `CameraSegmenter.find` tries itself
_GAMMA = 2.2  # of nearly every webcam
_XYZ_TO_SRGB = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)
_NEUTRAL_MIRED = 1e6 / 6504.0
_MINKOWSKI = 6.0


def light_hypotheses(pixels: Bytes) -> tuple[Floats, ...]:
    """White balances W (3,3), model_from_camera on RGB 0..1, that undo all lights to try on a picture (h,w,3) BGR: those of
    the locus with its tints, and averages of the picture.

    Grey world: the mean of a room is grey [Buchsbaum 1980]; shades of grey: so is its Minkowski mean
    of order 6 [Finlayson & Trezzi 2004].
    """
    lights = [black_body_rgb(mired, tint) for tint in TINTS_UV for mired in MIREDS]
    gains = [_unit_gain(rgb ** (-1.0 / _GAMMA)) for rgb in lights]
    flat = pixels.reshape(-1, 3)[:, ::-1] / 255.0
    gains.append(_unit_gain(1.0 / np.maximum(flat.mean(axis=0), 1e-3)))
    shades = np.mean(flat**_MINKOWSKI, axis=0) ** (1.0 / _MINKOWSKI)
    gains.append(_unit_gain(1.0 / np.maximum(shades, 1e-3)))
    return tuple(np.diag(gain * level) for gain in gains for level in LEVELS)


def black_body_rgb(mired: float, tint_uv: float = 0.0) -> Floats:
    """Linear sRGB (3,) of a light at 1e6 / mired kelvin, relative to neutral light, greenness 1.

    The locus in CIE 1960 uv by the rational approximation of [Krystek 1985]; tint_uv > 0 is the
    distance from it to the green side, < 0 to the magenta one.
    """
    light = _linear_srgb(_locus_uv(mired, tint_uv)) / _linear_srgb(_locus_uv(_NEUTRAL_MIRED, 0.0))
    rgb: Floats = np.maximum(light, 0.02) / light[1]
    return rgb


def _locus_uv(mired: float, tint_uv: float) -> Floats:
    step = 1.0
    here, beyond = _krystek(1e6 / mired), _krystek(1e6 / (mired + step))
    along = (beyond - here) / np.linalg.norm(beyond - here)
    # towards more mired is towards red; green lies to the left of that way
    return here + tint_uv * np.array([-along[1], along[0]])


def _krystek(kelvin: float) -> Floats:
    t, t2 = kelvin, kelvin * kelvin
    u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t2) / (
        1.0 + 8.42420235e-4 * t + 7.08145163e-7 * t2
    )
    v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t2) / (
        1.0 - 2.89741816e-5 * t + 1.61456053e-7 * t2
    )
    return np.array([u, v])


def _linear_srgb(uv: Floats) -> Floats:
    u, v = uv
    x, y = 3.0 * u / (2.0 * u - 8.0 * v + 4.0), 2.0 * v / (2.0 * u - 8.0 * v + 4.0)
    rgb: Floats = _XYZ_TO_SRGB @ np.array([x / y, 1.0, (1.0 - x - y) / y])
    return rgb


def _unit_gain(gain: Floats) -> Floats:
    """The same ratios with geometric mean 1, which separates hue from brightness."""
    balanced: Floats = gain / np.exp(np.log(gain).mean())
    return balanced
