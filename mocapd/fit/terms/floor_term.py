"""Feet are not under the floor, without a jump one or both touch it, and a foot that stands does not slide.

The paper's future work (Hecht et al. 2009, section V.B): external constraints. Where cameras look from one side it fixes how
far away the feet are, which nothing else does. Where their views cross, pictures show how high feet are, and the floor hardly
pulls: held firmly, feet in a jump were 5 cm too low and bent knees 10 degrees too straight.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel, Shaped
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.terms.point_rows_kernels import hold_on_floor, stand_on_floor
from mocapd.types import Floats, Ints

_TOES = [INDEX[side + "Toes"] for side in SIDES]
# of a foot that stands
_ANKLE_SD_M = 0.004  # pixels by the hundred pull at it
_TOES_SD_M = 0.02  # early estimates of the foot's direction err
_ROBUST_M = 0.03  # this far away from its place a joint is held by a quarter


@dataclass(frozen=True, slots=True)
class FloorParams:
    """How firm the floor is; by default as before cameras that look from one side."""

    under_sd_m: float = 0.01  # of an ankle or a toe that is too low
    on_floor_sd_m: float = 0.01  # of one on the floor: pixels by the hundred pull at it
    together_m: float = 0.08  # what is higher than the lowest by less stands, too
    jump_m: float = 0.25  # at this height the pull to the floor has lost half of its weight


CROSSING_VIEWS = FloorParams(under_sd_m=0.03, on_floor_sd_m=0.03)


class FloorTerm:
    """The floor at y = 0 under one body model, a `Term`."""

    is_measured = False

    def __init__(self, model: BodyModel, params: FloorParams | None = None) -> None:
        self._model, self._params = model, params if params is not None else FloorParams()
        # a picture shows how high a shoe is, and hardly whether its heel is up
        self._feet = np.array([INDEX[side + bone] for side in SIDES for bone in ("Foot", "Toes")])

    def add(self, posed: PosedJoints, body: Shaped, H: Floats, b: Floats, /) -> float:
        """See `Term`."""
        m, p = self._model, self._params
        cost: float = stand_on_floor(
            self._feet, body.rest[self._feet, 1], (1.0 / p.under_sd_m**2, 1.0 / p.on_floor_sd_m**2),
            p.together_m, p.jump_m, plain(m.articulation), plain(posed), H, b,
        )  # fmt: skip
        return cost


class PlantedTerm:
    """Joints (F,) of feet that stand, held at their places (F,2) along x and z [m, world] with firmness (F,), up to 1; a
    `Term`."""

    is_measured = False

    def __init__(self, model: BodyModel, joints: Ints, places_m: Floats, firmness: Floats) -> None:
        self._model, self._joints = model, joints
        self._places_m = np.ascontiguousarray(places_m)
        sd_m = np.where(np.isin(joints, _TOES), _TOES_SD_M, _ANKLE_SD_M)
        self._information = firmness / sd_m**2

    def add(self, posed: PosedJoints, _: Shaped, H: Floats, b: Floats, /) -> float:
        """See `Term`."""
        cost: float = hold_on_floor(
            self._joints, self._places_m, self._information, _ROBUST_M, plain(self._model.articulation), plain(posed), H, b,
        )  # fmt: skip
        return cost
