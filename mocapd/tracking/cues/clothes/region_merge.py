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
from mocapd.tracking.cues.clothes.regions import Band, Region, merged_labels
from mocapd.types import Camera

RegionMerge = tuple[int, ...]  # for region 0..: the region that it is merged with, or itself

NO_MERGE: RegionMerge = (0, *(int(part) for part in (*Region, *Band)))
# the merge of a new track and those of recent people; each has some 5 MB of buffers
_CACHE_SIZE = 4
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


def choose_merge(cameras: Sequence[Appearance], alike: float) -> RegionMerge:
    """Where the cameras' histograms put the ends of shirt and sleeves; regions whose colours overlap by more than
    `alike`, 0..1, are merged."""
    merge = list(NO_MERGE)
    for limb, bands, trunk in _CHAINS:
        limbs = _bands_of_limb(cameras, limb, bands, trunk)
        for k, band in enumerate(bands):
            merge[band] = limb if k < limbs else trunk
    for one, other in _MAY_BE_ONE:
        if np.mean([appearance.overlap(one, other) for appearance in cameras]) > alike:
            merge[one] = other
    for k in range(len(merge)):
        while merge[merge[k]] != merge[k]:
            merge[k] = merge[merge[k]]
    return tuple(merge)


def _bands_of_limb(
    cameras: Sequence[Appearance], limb: Region, bands: Sequence[Band], trunk: Region
) -> int:
    """How many of the bands look like the limb that they begin at, rather than like the trunk."""
    likelier = [
        float(np.mean([one.overlap(band, limb) - one.overlap(band, trunk) for one in cameras]))
        for band in bands
    ]
    return int(np.argmax([sum(likelier[:n]) - sum(likelier[n:]) for n in range(len(bands) + 1)]))


class RegionSolvers(NamedTuple):
    """The fitter and limb searches of one region merge."""

    fitter: Fitter
    arms: ArmSearch
    legs: LegSearch


class RegionSolverCache:
    """A cache of the solvers of recent region merges."""

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
        self._cache: dict[RegionMerge, RegionSolvers] = {}

    def of(self, merge: RegionMerge) -> RegionSolvers:
        """The solvers of this merge, from the cache if present."""
        solvers = self._cache.pop(merge, None)
        if solvers is None:
            labels = merged_labels(self._body, merge)
            fitter = Fitter(self._body, labels, self._cameras, self._scales, self._fit, self._each)
            solvers = RegionSolvers(
                fitter, ArmSearch(fitter, self._limbs), LegSearch(fitter, self._legs)
            )
        self._cache[merge] = solvers
        if len(self._cache) > _CACHE_SIZE:
            del self._cache[next(iter(self._cache))]
        return solvers
