"""Which regions look alike on this wearer, and so are one: a bare forearm and its hand, a long sleeve and the trunk.

Regions that differ place the limbs; of regions alike, which pixel belongs to which is only what was predicted, and holds
a limb where it was thought to be.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import FitParams, LegSearchParams, LimbSearchParams
from mocapd.fit.limbs.arm_search import ArmSearch
from mocapd.fit.limbs.leg_search import LegSearch
from mocapd.fit.solver import Fitter
from mocapd.tracking.cues.clothes.appearance import Appearance
from mocapd.tracking.cues.clothes.regions import Band, Region, worn_labels
from mocapd.types import Camera

Look = tuple[
    int, ...
]  # by region 0..: the region whose colours it shares, itself where it has its own

ALL_DIFFER: Look = (0, *(int(part) for part in (*Region, *Band)))
# the look that somebody is found with, and of those who come in turn; each has some 5 MB of buffers
_KEPT = 4
_MAY_BE_ONE = (
    (Region.HAND, Region.FOREARM),
    (Region.FOREARM, Region.TRUNK),
    (Region.HAIR, Region.FACE),
    (Region.FOOT, Region.LEG),
)
# Bands from the end of a limb on, between its region and the one at the chain's other end
_CHAINS = (
    (Region.LEG, (Band.LOW_HIPS, Band.HIGH_HIPS, Band.WAIST), Region.TRUNK),
    (Region.FOREARM, (Band.LOW_SLEEVE, Band.HIGH_SLEEVE), Region.TRUNK),
)


def look_of(seen: Sequence[Appearance], alike: float) -> Look:
    """What the cameras learned: where shirt and sleeves end, and that regions whose colours overlap by more than `alike`,
    0..1, are one."""
    look = list(ALL_DIFFER)
    for limb, bands, trunk in _CHAINS:
        limbs = _bands_of_limb(seen, limb, bands, trunk)
        for k, band in enumerate(bands):
            look[band] = limb if k < limbs else trunk
    for one, other in _MAY_BE_ONE:
        if np.mean([appearance.overlap(one, other) for appearance in seen]) > alike:
            look[one] = other
    for k in range(len(look)):
        while look[look[k]] != look[k]:
            look[k] = look[look[k]]
    return tuple(look)


def _bands_of_limb(
    seen: Sequence[Appearance], limb: Region, bands: Sequence[Band], trunk: Region
) -> int:
    """How many of the bands look like the limb that they begin at, rather than like the trunk."""
    likelier = [
        float(np.mean([one.overlap(band, limb) - one.overlap(band, trunk) for one in seen]))
        for band in bands
    ]
    return int(np.argmax([sum(likelier[:n]) - sum(likelier[n:]) for n in range(len(bands) + 1)]))


class Dressed(NamedTuple):
    """What works with one look."""

    fitter: Fitter
    arms: ArmSearch
    legs: LegSearch


class DressedFitters:
    """Fitter and searches for arms and legs of each look, made when it is asked for; the newest are kept."""

    def __init__(
        self,
        body: BodyModel,
        cameras: Sequence[Camera],
        image_scales: Sequence[int],
        fit: FitParams,
        limbs: LimbSearchParams,
        legs: LegSearchParams,
        each: Each = in_turn,
    ) -> None:
        """body: a whole one; image_scales, each: as `Fitter`."""
        self._body, self._cameras, self._scales = body, cameras, image_scales
        self._fit, self._limbs, self._legs, self._each = fit, limbs, legs, each
        self._made: dict[Look, Dressed] = {}

    def of(self, look: Look) -> Dressed:
        """The same ones to whoever asks for the same look, unless _KEPT others were asked for since."""
        dressed = self._made.pop(look, None)
        if dressed is None:
            labels = worn_labels(self._body, look)
            fitter = Fitter(self._body, labels, self._cameras, self._scales, self._fit, self._each)
            dressed = Dressed(fitter, ArmSearch(fitter, self._limbs), LegSearch(fitter, self._legs))
        self._made[look] = dressed
        if len(self._made) > _KEPT:
            del self._made[next(iter(self._made))]
        return dressed
