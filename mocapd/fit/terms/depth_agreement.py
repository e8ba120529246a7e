"""Cost of the drawn body's distance from the stereo depth. It compares poses and adds no rows to the normal
equations."""

from collections.abc import Sequence

import numpy as np

from mocapd.body.areas import N_AREAS
from mocapd.fit.fit_params import FitParams
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.stereo_depth import GRID_PX
from mocapd.fit.terms.depth_agreement_kernels import compare_depths
from mocapd.fit.view import View
from mocapd.types import Floats


def compared_depths(
    drawings: Sequence[IdMapRenderer], views: Sequence[View], p: FitParams
) -> tuple[float, Floats, float]:
    """The cost of last drawn pixels off the stereo depth; the agreement by area (A,); and the number of pixels with an
    object well in front of the drawn body."""
    if all(view.depth_m is None for view in views):
        return 0.0, np.ones(N_AREAS), 0.0
    cost = nearer_px = 0.0
    asked, off = np.zeros(N_AREAS), np.zeros(N_AREAS)
    for view in views:
        if view.depth_m is not None:
            drawing = drawings[view.index]
            away, nearer = compare_depths(
                drawing.last_depth_m(view.roi), drawing.last(view.roi)[1], drawing.labels.area, view.depth_m, GRID_PX,
                p.depth_around_px, p.depth_off_m, asked, off,
            )  # fmt: skip
            cost += p.depth_cost * away
            nearer_px += nearer
    share = np.minimum(p.depth_usual * (1.0 - off / np.maximum(asked, 1.0)), 1.0)
    return cost, np.where(asked >= p.depth_least_px, share, 1.0), nearer_px
