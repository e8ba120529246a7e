"""One camera's evidence of one frame set, as the fit takes it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.fit.idmap_renderer import Roi


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One camera's evidence: ids and pixel_weight (h,w) over `roi`, taken dt_s after the asked instant; bare (h,w):
    possible skin, if searched for; depth_m (h,w): stereo depth along the camera's axis [m], NaN where
    unknown."""

    index: int
    roi: Roi
    ids: NDArray[np.uint8]
    pixel_weight: NDArray[np.uint8]
    dt_s: float
    bare: NDArray[np.bool_] | None = None
    depth_m: NDArray[np.float32] | None = None


def coarse(view: View) -> View:
    """Labels at every second pixel each way."""
    ids, pixel_weight = view.ids[::2, ::2].copy(), view.pixel_weight[::2, ::2].copy()
    return View(view.index, view.roi, ids, pixel_weight, view.dt_s)
