"""Colour model of a head in one camera, learned at the face for any skin, hair and light.

Two pairs of histograms, as log odds of the head against its surroundings: of colours, for the whole head with its hair;
and of chrominance, for skin (the segmentation of Hecht, Azad and Dillmann 2009, section III.B).
"""

from dataclasses import dataclass

import numpy as np

from mocapd.published.hecht2009.head.head_colour_kernels import SIDE, log_odds
from mocapd.types import Bytes, Floats, Ints, Singles

MEMORY_S = 1.0  # time constant of what is learned
_MIDDLE_GREY = 100.0  # brightness that colours are scaled to, so that dimmed light changes little
_GAIN = (0.5, 4.0)
_FLOOR = 0.05  # share of the counts that all unseen colours are taken to have
_CHROMA = 32  # bins of the shares of red and of green
_DARK = 40  # sum of the channels below which their shares mean nothing
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
    colours, chroma = SIDE**3, _CHROMA**2
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
    part = picture[y0:y1:4, x0:x1:4]
    return float(np.clip(_MIDDLE_GREY / max(part.sum() / part.size, 1.0), *_GAIN))


def update_colours(
    colours: HeadColours, picture: Bytes, outline: HeadEllipse, facing: bool, dt_s: float
) -> HeadColours:
    """Updated with this picture (H,W,3) BGR; `facing`: a face was detected in it, so that its middle is skin."""
    head, around, skin, other = _count(picture, outline, facing)
    keep = np.float32(np.exp(-dt_s / MEMORY_S))
    head, around = keep * colours.head + head, keep * colours.around + around
    kept_skin = keep if facing else np.float32(1.0)
    skin, other = kept_skin * colours.skin + skin, kept_skin * colours.other + other
    return HeadColours(head, around, skin, other, _odds(head, around), _chroma_odds(skin, other))


@dataclass(frozen=True, slots=True, eq=False)
class _Samples:
    """Pixels (S,3) BGR near a head, and where they lie: from its middle (S,) [px], and in half widths and heights (S,)."""

    pixels: Bytes
    away_px: Floats
    across: Floats
    along: Floats


def _samples(picture: Bytes, outline: HeadEllipse, reach_px: tuple[float, float]) -> _Samples:
    """So far to the sides and up and down from its middle. A large head in few steps: some two thousand pixels say as much
    as more."""
    h, w, _ = picture.shape
    x, y, half_w, half_h = outline.ellipse.tolist()
    step, (beside, above) = max(1, int(half_w / 12.0)), reach_px
    rows = np.arange(max(0, int(y - above)), min(h, int(y + above) + 1), step)
    columns = np.arange(max(0, int(x - beside)), min(w, int(x + beside) + 1), step)
    v, u = (at.ravel() for at in np.meshgrid(rows, columns, indexing="ij"))
    dx, dy, up = u - x, v - y, outline.up
    across, along = (dx * -up[1] + dy * up[0]) / half_w, (dx * up[0] + dy * up[1]) / half_h
    return _Samples(picture[v, u], np.hypot(dx, dy), across, along)


def _count(picture: Bytes, outline: HeadEllipse, facing: bool) -> list[Singles]:
    """Pixels up to 0.85 of the head's outline and from 1.3 to 2.2 of it, the neck left out, by colour; of these, where a
    face is seen, those of the face and those outside of the head, by chrominance."""
    reach_px = 2.2 * float(outline.ellipse[3])
    near = _samples(picture, outline, (reach_px, reach_px))
    rho2 = near.across * near.across + near.along * near.along
    head = rho2 < 0.7225
    neck = (near.along < 0.0) & (np.abs(near.across) < 0.9)
    around = (rho2 > 1.69) & (rho2 < 4.84) & ~neck
    cells = np.minimum((near.pixels * light_gain(picture, outline)).astype(np.int64) >> 4, SIDE - 1)
    colour = (cells[:, 0] * SIDE + cells[:, 1]) * SIDE + cells[:, 2]
    chroma = chroma_bins(near.pixels)
    counted = (head | around) & (chroma >= 0) & facing
    face = near.away_px < _FACE * outline.ellipse[2]
    of_colour = [np.bincount(colour[which], minlength=SIDE**3) for which in (head, around)]
    of_chroma = [
        np.bincount(chroma[counted & which], minlength=_CHROMA**2)
        for which in (face, ~face & (rho2 > 1.0))
    ]
    return [counts.astype(np.float32) for counts in (*of_colour, *of_chroma)]


def chroma_bins(pixels: Bytes) -> Ints:
    """(S,) by the shares of red and of green; -1 where it is too dark to tell."""
    total = pixels.sum(axis=1, dtype=np.int64)
    shares = _CHROMA * pixels.astype(np.int64) // np.maximum(total, 1)[:, None]
    bins = np.minimum(shares[:, 2], _CHROMA - 1) * _CHROMA + np.minimum(shares[:, 1], _CHROMA - 1)
    return np.where(total < _DARK, -1, bins)


def _odds(mine: Singles, others: Singles) -> Singles:
    return _chroma_odds(_spread(mine), _spread(others))


def _spread(counts: Singles) -> Singles:
    """Counts (SIDE^3,) spread over neighbouring bins, 1 2 1 along each axis."""
    out, place = counts.reshape(SIDE, SIDE, SIDE), np.arange(SIDE)
    for axis in (2, 1, 0):
        low, high = (np.take(out, place + way, axis, mode="clip") for way in (-1, 1))
        out = np.float32(0.25) * (low + high) + np.float32(0.5) * out
    return out.ravel()


def _chroma_odds(skin: Singles, other: Singles) -> Singles:
    out = np.empty_like(skin)
    log_odds(skin, other, _FLOOR, out)
    return out


def face_side(
    colours: HeadColours, picture: Bytes, outline: HeadEllipse
) -> tuple[float, float] | None:
    """Share of the head that is skin, and how far its middle lies to the picture's right, -1..1; None: unknown."""
    if float(colours.skin.sum()) < _LEAST:
        return None
    _, _, half_w, half_h = outline.ellipse.tolist()
    near = _samples(picture, outline, (half_w, half_h))
    inside = near.across * near.across + near.along * near.along <= 0.9
    chroma = chroma_bins(near.pixels)
    bare = inside & (chroma >= 0) & (colours.skin_odds[chroma] > 0.0)
    to_right: list[float] = near.across[bare].tolist()
    return len(to_right) / max(int(inside.sum()), 1), sum(to_right) / max(len(to_right), 1)
