"""Point-to-ray distance term: points of the body's surface at stereo distances.

Silhouettes of cameras side by side say little along their views; the cloth's own texture does (Horaud et al. 2009 align
the surface with stereo points; here each point has the triangle it was predicted on).
"""

from dataclasses import dataclass

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel, Shaped
from mocapd.fit.terms.point_rows_kernels import pull_along_rays
from mocapd.types import Floats, Ints

_ROBUST_M = 0.12  # a residual of this has a quarter of its weight: a mismatch


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredDistances:
    """triangle (N,) of the body, and how far away it is from origin_m (3,) along the unit vectors rays (N,3):
    distance_m (N,), each with its standard deviation sd_m (N,)."""

    triangle: Ints
    origin_m: Floats
    rays: Floats
    distance_m: Floats
    sd_m: Floats


class DistanceTerm:
    """The distances of one frame set for one body model, a `Term`."""

    is_measured = True

    def __init__(self, model: BodyModel, measured: MeasuredDistances) -> None:
        self._model, self._measured = model, measured
        self._information = 1.0 / measured.sd_m**2

    def add(self, posed: PosedJoints, body: Shaped, H: Floats, b: Floats, /) -> float:
        """See `Term`."""
        m, points = self._model, self._measured
        cost: float = pull_along_rays(
            points.triangle, points.origin_m, points.rays, points.distance_m, self._information, _ROBUST_M,
            body.centres, plain(m.surface), plain(m.articulation), plain(posed), H, b,
        )  # fmt: skip
        return cost
