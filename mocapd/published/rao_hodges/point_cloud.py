"""Points that limbs are matched with, and how densely they fill a body."""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats, Singles

_SIDE_M = 0.08  # of the cubes in which points are counted: as thick as an arm


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """points_m (3,P): rows x, y, z [m, world]; per_m3: how many there are in a cubic metre of what they fill."""

    points_m: Singles
    per_m3: float

    @property
    def count(self) -> int:
        """How many points there are."""
        return int(self.points_m.shape[1])


def point_cloud(points_m: Floats, per_m3: float | None = None) -> PointCloud:
    """Of points (P,3) [m]. per_m3: where it is not known, it is counted in the cubes of a grid, each weighted by its
    points, less the one that is counted for itself; cubes at the surface, half full, make it less than inside."""
    rows = np.ascontiguousarray(points_m.T, np.float32)
    if per_m3 is None:
        at = np.floor(points_m / _SIDE_M).astype(np.int64)
        _, counts = np.unique(at, axis=0, return_counts=True) if len(at) else (None, np.zeros(0))
        mean = float((counts**2).sum() / max(len(at), 1)) - 1.0
        per_m3 = max(mean, 1.0) / _SIDE_M**3
    return PointCloud(rows, per_m3)
