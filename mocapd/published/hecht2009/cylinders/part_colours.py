"""Appearance of the body parts: ten reference colours along each axis, learned and then fixed [Hecht et al. 2009, III.B].

Each camera has colours of its own: two webcams show one sleeve differently, and from different sides. A ring of a part is
fixed after it was clearly visible for long enough, so a part that is hidden at first is learned when it appears.
"""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.published.hecht2009.cylinders.occlusion_kernels import OcclusionModel
from mocapd.published.hecht2009.cylinders.part_colour_kernels import observe_colours
from mocapd.types import Bytes, Floats, Singles

RINGS = 10
ENOUGH_S = 1.0  # of sure and full view, after which a ring's colour is fixed
_SAMPLES = 2, 6  # of a ring, along and across


@dataclass(frozen=True, slots=True, eq=False)
class AppearanceModel:
    """Of V cameras and C parts: colour (V,C,10,3) BGR 0..255 at the middles of ten rings from start to end; visible_s
    (V,C,10): time that each was visible, weighted by confidence and visible share."""

    colour: Singles
    visible_s: Floats

    @classmethod
    def initial(cls, n_views: int, n_parts: int) -> "AppearanceModel":
        return cls(
            np.zeros((n_views, n_parts, RINGS, 3), np.float32), np.zeros((n_views, n_parts, RINGS))
        )

    @property
    def is_fixed(self) -> bool:
        """True if no ring in any view changes any more."""
        return bool((self.visible_s >= ENOUGH_S).all())


@dataclass(frozen=True, slots=True, eq=False)
class RingColours:
    """One picture's mean colour (C,10,3) BGR of each ring, and the share (C,10) of its samples that count."""

    colour: Singles
    share: Floats


def observe(
    quads: Floats,
    depths_m: Floats,
    colour: Bytes,
    mask: Bytes,
    occlusion: OcclusionModel,
    hidden_by_m: float,
) -> RingColours:
    """The rings of parts (C,4,2) [work px], (C,2) [m] in a work picture (h,w,3); mask (h,w): not 0 on the person."""
    mean, share = np.empty((len(quads), RINGS, 3), np.float32), np.empty((len(quads), RINGS))
    observe_colours(
        quads, depths_m, colour, mask, occlusion, _SAMPLES, hidden_by_m, mean, share
    )  # fmt: skip
    return RingColours(mean, share)


def learn(
    model: AppearanceModel,
    view: int,
    observed: RingColours,
    confidence: Floats,
    dt_s: float,
) -> AppearanceModel:
    """The running average with one more picture of camera `view`, taken dt_s after the one before.

    confidence (C,2): 0..1 of both ends of each part, interpolated along it.
    """
    s = (np.arange(RINGS) + 0.5) / RINGS
    local = confidence[:, :1] * (1.0 - s) + confidence[:, 1:] * s
    before_s = model.visible_s[view]
    gain = np.where(before_s < ENOUGH_S, np.clip(local, 0.0, 1.0) * observed.share * dt_s, 0.0)
    colours, visible_s = model.colour.copy(), model.visible_s.copy()
    rate = gain / np.maximum(before_s + gain, 1e-12)
    colours[view] += rate[..., None] * (observed.colour - colours[view])
    visible_s[view] += gain
    return replace(model, colour=colours, visible_s=visible_s)


def reference_colours(model: AppearanceModel, along: int) -> Singles:
    """Colours (V,C,along,3) at the middles of `along` rows, interpolated between rings; at the ends and for unlearned rings
    the nearest learned colour. NaN: no ring of the part is learned."""
    n_views, n_parts, _, _ = model.colour.shape
    rows = (np.arange(along) + 0.5) / along * RINGS - 0.5
    out = np.full((n_views, n_parts, along, 3), np.nan, np.float32)
    for v in range(n_views):
        for c in range(n_parts):
            learned = np.flatnonzero(model.visible_s[v, c] > 0.0)
            if len(learned):
                for k in range(3):
                    out[v, c, :, k] = np.interp(rows, learned, model.colour[v, c, learned, k])
    return out
