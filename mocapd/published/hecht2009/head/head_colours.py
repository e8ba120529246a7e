"""Colour model of a head in one camera, learned at the face for any skin, hair and light.

Two pairs of histograms, as log odds of the head against its surroundings: of colours, for the whole head with its hair;
and of chrominance, for skin (the segmentation of Hecht, Azad and Dillmann 2009, section III.B).
"""

from dataclasses import dataclass

import numpy as np

from mocapd.published.hecht2009.head import head_colour_kernels as kernels
from mocapd.types import Bytes, Floats, Singles

MEMORY_S = 1.0  # time constant of what is learned
_MIDDLE_GREY = 100.0  # brightness that colours are scaled to, so that dimmed light changes little
_GAIN = (0.5, 4.0)
_FLOOR = 0.05  # share of the counts that all unseen colours are taken to have
_FACE = 0.6  # of the head's half width: a disc within the face, with neither hair nor collar
_LEAST = 30.0  # counts before odds mean anything


@dataclass(frozen=True, slots=True, eq=False)
class HeadColours:
    """Counts head, around (4096,) by colour; skin, other (1024,) by chrominance; log odds -1..1 of both."""

    head: Singles
    around: Singles
    skin: Singles
    other: Singles
    head_odds: Singles
    skin_odds: Singles


@dataclass(frozen=True, slots=True, eq=False)
class HeadEllipse:
    """A head's outline in a picture: middle x, y, half width, half height (4,) [px]; up (2,): unit vector to its top."""

    ellipse: Floats
    up: Floats


def initial_colours() -> HeadColours:
    """The initial state: all odds are even."""
    colours, chroma = kernels.SIDE**3, kernels.CHROMA**2
    return HeadColours(*(np.zeros(n, np.float32) for n in (colours, colours, chroma, chroma, colours, chroma)))  # fmt: skip


def has_colours(colours: HeadColours) -> bool:
    """True after the first learned head."""
    return float(colours.head.sum()) >= _LEAST


def light_gain(picture: Bytes, outline: HeadEllipse) -> float:
    """What brings the surroundings of a head to middle grey; 1 where they lie outside of picture (H,W,3)."""
    h, w, _ = picture.shape
    x, y, _, half_h = outline.ellipse.tolist()
    reach = 2.2 * half_h
    x0, x1 = max(0, int(x - reach)), min(w, int(x + reach) + 1)
    y0, y1 = max(0, int(y - reach)), min(h, int(y + reach) + 1)
    if x1 <= x0 or y1 <= y0:
        return 1.0
    mean = kernels.brightness(picture, x0, y0, x1, y1)
    return float(np.clip(_MIDDLE_GREY / max(mean, 1.0), *_GAIN))


def update_colours(
    colours: HeadColours, picture: Bytes, outline: HeadEllipse, facing: bool, dt_s: float
) -> HeadColours:
    """Updated with this picture (H,W,3) BGR; `facing`: a face was detected in it, so that its middle is skin."""
    head, around, skin, other = (
        np.zeros_like(a) for a in (colours.head, colours.around, colours.skin, colours.other)
    )
    gain = light_gain(picture, outline)
    kernels.count_head(
        picture, outline.ellipse, outline.up, gain, _FACE if facing else 0.0, head, around, skin, other
    )  # fmt: skip
    keep = np.float32(np.exp(-dt_s / MEMORY_S))
    head, around = keep * colours.head + head, keep * colours.around + around
    kept_skin = keep if facing else np.float32(1.0)
    skin, other = kept_skin * colours.skin + skin, kept_skin * colours.other + other
    return HeadColours(head, around, skin, other, _odds(head, around), _chroma_odds(skin, other))


def _odds(mine: Singles, others: Singles) -> Singles:
    a, b, out = np.empty_like(mine), np.empty_like(mine), np.empty_like(mine)
    kernels.blur3(mine, a)
    kernels.blur3(others, b)
    kernels.log_odds(a, b, _FLOOR, out)
    return out


def _chroma_odds(skin: Singles, other: Singles) -> Singles:
    out = np.empty_like(skin)
    kernels.log_odds(skin, other, _FLOOR, out)
    return out


def face_side(
    colours: HeadColours, picture: Bytes, outline: HeadEllipse
) -> tuple[float, float] | None:
    """Share of the head that is skin, and how far its middle lies to the picture's right, -1..1; None: unknown."""
    if float(colours.skin.sum()) < _LEAST:
        return None
    share, side = kernels.skin_side(picture, outline.ellipse, outline.up, colours.skin_odds)
    return float(share), float(side)
