"""Distance maps d(r, k) of an id map (paper §5.2 step 3)."""

import numpy as np
from numpy.typing import NDArray

from mocapd.published.wang2011 import distance_kernels
from mocapd.shirt.standard_shirt import N_COLOURS
from mocapd.types import Bytes, Singles


def distance_maps(ids: Bytes, limit_px: float) -> tuple[Singles, NDArray[np.int16]]:
    """Distances (10,h,w) [samples] from every sample of `ids` (h,w) to each colour, truncated at `limit_px`; and row and
    column (10,h,w,2) of the nearest sample of it."""
    distance_px = np.empty((N_COLOURS, *ids.shape), np.float32)
    nearest_yx = np.empty((N_COLOURS, *ids.shape, 2), np.int16)
    distance_kernels.distance_maps(ids, limit_px, distance_px, nearest_yx)
    return distance_px, nearest_yx
