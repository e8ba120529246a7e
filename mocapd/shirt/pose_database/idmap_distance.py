"""The nearest of many id maps by the exact distance."""

import numpy as np
from numpy.typing import NDArray

from mocapd.shirt.pose_database.idmap_crop_kernels import N_IDS, SIZE
from mocapd.shirt.pose_database.idmap_distance_kernels import nearest_in_order, one_way_distances
from mocapd.types import Bytes, Ints


def nearest_exact(
    query: Bytes, maps: Bytes, candidates: Ints, best: Ints, distance: NDArray[np.float64]
) -> None:
    """The k = len(best) nearest of maps[candidates] to `query` (SIZE,SIZE), nearest first.

    maps (N, SIZE*SIZE/2) packed. The direction that is one table look-up a pixel comes first, and the
    other only where the first alone does not exceed the k-th best. best holds indices into `maps`, -1
    where there are fewer than k candidates.
    """
    one_way = np.empty(len(candidates))
    one_way_distances(query, maps, candidates, np.empty((N_IDS, SIZE, SIZE), np.float32), one_way)
    order = np.argsort(one_way, kind="stable")  # numpy's: numba takes two seconds to compile a sort
    nearest_in_order(query, maps, candidates[order], one_way[order], best, distance)
