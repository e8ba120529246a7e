"""A foot that stands does not slide: its ankle and toes are held where they have been for a while."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arrays import PosedJoints
from mocapd.body.model import BodyModel
from mocapd.body.shaping import Shaped
from mocapd.fit.terms.point_rows_kernels import hold_on_floor
from mocapd.types import Floats, Ints


@dataclass(frozen=True, slots=True)
class PlantedParams:
    """How firmly a foot stands."""

    sd_m: float = 0.004  # pixels by the hundred pull at it
    robust_m: float = 0.03  # away from its place, a foot has three quarters of its freedom


class PlantedTerm:
    """Joints (F,) of feet that stand, with their places (F,2) along x and z [m, world], a `Term`."""

    is_measured = False

    def __init__(
        self, model: BodyModel, joints: Ints, places_m: Floats, params: PlantedParams
    ) -> None:
        self._model, self._joints, self._params = model, joints, params
        self._places_m = np.ascontiguousarray(places_m)

    def add(self, posed: PosedJoints, body: Shaped, H: Floats, b: Floats) -> float:
        """See `Term`."""
        m, p = self._model, self._params
        cost: float = hold_on_floor(
            self._joints, self._places_m, 1.0 / p.sd_m**2, p.robust_m, body.rest, m.parents,
            m.joint_of_group, m.group_of_joint, m.share_of_joint, posed.R, posed.joints, H, b,
        )  # fmt: skip
        return cost
