"""Points that limbs are matched with."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Floats, Singles


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """points_m (3,P): rows x, y, z [m, world]; per_m3: how many there are in a cubic metre of what they fill."""

    points_m: Singles
    per_m3: float

    @property
    def count(self) -> int:
        """How many points there are."""
        return int(self.points_m.shape[1])

    def where(self, which: NDArray[np.bool_]) -> "PointCloud":
        """Some of the points (P,), as dense as all."""
        return PointCloud(np.ascontiguousarray(self.points_m[:, which]), self.per_m3)


def point_cloud(points_m: Floats, per_m3: float) -> PointCloud:
    """Of points (P,3) [m]."""
    return PointCloud(np.ascontiguousarray(points_m.T, np.float32), per_m3)
