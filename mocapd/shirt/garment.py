"""The standard shirt as a garment: the label of a triangle is the colour of the patch on it."""

from functools import lru_cache

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.fit.fit_result import Fit, confirmed_parts
from mocapd.fit.surface_labels import SurfaceLabels, surface_labels
from mocapd.shirt.standard_shirt import standard_shirt


@lru_cache(maxsize=8)
def shirt_labels(model: BodyModel) -> SurfaceLabels:
    """Of a body in the shirt: labels are its colours 1..10; pixels are counted in its patches."""
    return surface_labels(standard_shirt().colour_of_patch[model.area], model.area)


def confirmed_colours(fit: Fit) -> int:
    """How many colours of the shirt are confirmed in one of their patches."""
    patches = np.flatnonzero(confirmed_parts(fit.matched, fit.visible))
    return int(np.count_nonzero(np.unique(standard_shirt().colour_of_patch[patches])))
