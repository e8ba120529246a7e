"""A foot that stands does not slide: its ankle and toes are held where they have been for a while."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel
from mocapd.body.pose_space import SIDES
from mocapd.body.shaping import Shaped
from mocapd.body.skeleton import INDEX
from mocapd.fit.terms.point_rows_kernels import hold_on_floor
from mocapd.types import Floats, Ints

_TOES = [INDEX[side + "Toes"] for side in SIDES]


@dataclass(frozen=True, slots=True)
class PlantedParams:
    """How firmly a foot stands."""

    ankle_sd_m: float = 0.004  # pixels by the hundred pull at it
    toes_sd_m: float = 0.02  # early estimates of the foot's direction err
    robust_m: float = 0.03  # this far away from its place a joint is held by a quarter


class PlantedTerm:
    """Joints (F,) of feet that stand, with their places (F,2) along x and z [m, world], a `Term`."""

    is_measured = False

    def __init__(
        self, model: BodyModel, joints: Ints, places_m: Floats, params: PlantedParams
    ) -> None:
        self._model, self._joints, self._params = model, joints, params
        self._places_m = np.ascontiguousarray(places_m)
        sd_m = np.where(np.isin(joints, _TOES), self._params.toes_sd_m, self._params.ankle_sd_m)
        self._information = 1.0 / sd_m**2

    def add(self, posed: PosedJoints, _: Shaped, H: Floats, b: Floats, /) -> float:
        """See `Term`."""
        m, p = self._model, self._params
        cost: float = hold_on_floor(
            self._joints, self._places_m, self._information, p.robust_m, plain(m.articulation), plain(posed), H, b
        )  # fmt: skip
        return cost
