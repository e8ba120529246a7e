"""Which regions look alike on this wearer, and so are one: a bare forearm and its hand, a long sleeve and the trunk.

Regions that differ place the limbs; of regions alike, which pixel belongs to which is only what was predicted, and holds
a limb where it was thought to be.
"""

from collections.abc import Sequence

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.regions import Region, recoloured, regions
from mocapd.fit.fit_params import FitParams, LimbSearchParams
from mocapd.fit.limb_search import ArmSearch
from mocapd.fit.solver import Fitter
from mocapd.trackers.flex.appearance import Appearance
from mocapd.types import Camera

Look = tuple[
    int, ...
]  # by region 0..: the region whose colours it shares, itself where it has its own

ALL_DIFFER: Look = (0, *(int(region) for region in Region))
_MAY_BE_ONE = (
    (Region.HAND, Region.FOREARM),
    (Region.FOREARM, Region.TRUNK),
    (Region.HAIR, Region.FACE),
    (Region.FOOT, Region.LEG),
)


def look_of(seen: Sequence[Appearance], alike: float) -> Look:
    """What the cameras learned: regions whose colours overlap by more than `alike`, 0..1, are one."""
    look = list(ALL_DIFFER)
    for one, other in _MAY_BE_ONE:
        if np.mean([appearance.overlap(one, other) for appearance in seen]) > alike:
            look[one] = other
    for k in range(len(look)):
        while look[look[k]] != look[k]:
            look[k] = look[look[k]]
    return tuple(look)


class DressedFitters:
    """Fitter and search for arms of each look, made when it is first asked for."""

    def __init__(
        self,
        body: BodyModel,
        cameras: Sequence[Camera],
        image_scales: Sequence[int],
        fit: FitParams,
        limbs: LimbSearchParams,
    ) -> None:
        """body: a whole one, in any colours; image_scales: as `Fitter`."""
        self._body, self._cameras, self._scales = body, cameras, image_scales
        self._fit, self._limbs = fit, limbs
        self._made: dict[Look, tuple[Fitter, ArmSearch]] = {}

    def of(self, look: Look) -> tuple[Fitter, ArmSearch]:
        """The same ones to whoever asks for the same look."""
        if look not in self._made:
            colour = np.array(look, np.uint8)[regions(self._body)]
            fitter = Fitter(recoloured(self._body, colour), self._cameras, self._scales, self._fit)
            self._made[look] = fitter, ArmSearch(fitter, self._limbs)
        return self._made[look]
