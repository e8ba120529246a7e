"""Distance maps d(r, k) of an id map (paper §5.2 step 3), in buffers that are allocated once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.published.wang2011 import distance_kernels
from mocapd.shirt.standard_shirt import N_COLOURS
from mocapd.types import Bytes, Singles


@dataclass(frozen=True, slots=True, eq=False)
class DistanceMaps:
    """Buffers for id maps of one size; the arrays are overwritten by each `fill`.

    distance_px (10,h,w) float32 [samples]; nearest_yx (10,h,w,2) int16, or (10,0,0,2) when the
    nearest samples are not stored; scratch (h,w).
    """

    distance_px: Singles
    nearest_yx: NDArray[np.int16]
    scratch: NDArray[np.int32]

    @classmethod
    def allocate(cls, height: int, width: int, nearest: bool = False) -> "DistanceMaps":
        """Buffers for id maps (height, width), with room for the nearest samples if asked."""
        kept = (height, width) if nearest else (0, 0)
        return cls(
            np.empty((N_COLOURS, height, width), dtype=np.float32),
            np.empty((N_COLOURS, *kept, 2), dtype=np.int16),
            np.empty((height, width), dtype=np.int32),
        )

    def fill(self, ids: Bytes, limit_px: float) -> Singles:
        """Distances from every sample of `ids` (h,w) to each colour, truncated at `limit_px`."""
        distance_kernels.distance_maps(
            ids, limit_px, self.scratch, self.distance_px, self.nearest_yx
        )
        return self.distance_px
