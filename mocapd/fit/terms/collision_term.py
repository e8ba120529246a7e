"""Arms do not go through the trunk: inside it an unseen arm would cost least.

The trunk is an elliptic cylinder with half axes that follow the wearer's surface by height, as the anisotropically scaled
cylinder of Hecht et al. 2009 (section 3.3); elbow, forearm, wrist and hand stay outside of it.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel, Shaped
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import TORSO
from mocapd.fit.terms.collision_kernels import SLICES, ArmChains, TorsoSlices, push_arms_out
from mocapd.types import Floats, Ints

_BELOW_HIPS_M = 0.12  # the cylinder begins there


@dataclass(frozen=True, slots=True, eq=False)
class TorsoHull:
    """The vertices of the trunk slice by slice, and where in them each slice begins (SLICES,); of one body model."""

    vertices: Ints
    first: Ints

    @classmethod
    def of(cls, model: BodyModel) -> "TorsoHull":
        """Cut the trunk of the mean body."""
        mine = np.unique(model.triangles[model.part == TORSO])
        y_m = model.vertices_m[mine, 1]
        low, high = _span_m(model.rest_m)
        place = np.clip(((y_m - low) / (high - low) * SLICES).astype(int), -1, SLICES)
        slices = [mine[place == k] for k in range(SLICES)]
        return cls(np.concatenate(slices), np.cumsum([0, *map(len, slices[:-1])]))

    def slices_of(self, body: Shaped) -> TorsoSlices:
        """Half axes and middles of the slices of a wearer, about the line from the hips to the upper chest [m]."""
        rest, first = body.rest, self.first
        hips, top = rest[INDEX["hips"]], rest[INDEX["upperChest"]]
        low, high = _span_m(rest)
        x, y, z = body.vertices[self.vertices].T
        counts = np.diff(first, append=len(self.vertices))
        along = (np.add.reduceat(y, first) / counts - hips[1]) / (top[1] - hips[1])
        back, front = np.minimum.reduceat(z, first), np.maximum.reduceat(z, first)
        line_z = hips[2] + along * (top[2] - hips[2])
        half_x, half_z = np.maximum.reduceat(np.abs(x), first), 0.5 * (front - back)
        out = np.stack([half_x, half_z, 0.5 * (front + back) - line_z], axis=1)
        return TorsoSlices(out, low - hips[1], high - hips[1])


def _span_m(rest_m: Floats) -> tuple[float, float]:
    """Lowest and highest y of the cylinder in the T-pose: from below the hips to below the shoulders."""
    hips_m, shoulder_m = rest_m[INDEX["hips"], 1], rest_m[INDEX["leftUpperArm"], 1]
    return float(hips_m - _BELOW_HIPS_M), float(shoulder_m - 0.04)


def arm_chains(model: BodyModel) -> ArmChains:
    """Both arms of a model."""
    chains = [[INDEX[name] for name in model.space.parts[f"{side}_arm"].joints] for side in SIDES]
    first = [model.space.columns(f"{side}_arm").start for side in SIDES]
    return ArmChains(
        np.array(chains), np.array(first), INDEX["hips"], INDEX["chest"], INDEX["upperChest"]
    )


class CollisionTerm:
    """The trunk of one body model as a `Term`; remembers the trunk of the last proportions."""

    is_measured = False

    def __init__(self, model: BodyModel, information: float) -> None:
        """information: of a depth in the trunk [1/m^2]."""
        self.arms = arm_chains(model)
        self._model, self._information = model, information
        self._hull, self._plain_arms = TorsoHull.of(model), plain(self.arms)
        self._body: Shaped | None = None

    def slices(self, body: Shaped) -> TorsoSlices:
        """The trunk of a body."""
        if self._body is not body:
            self._body, self._slices = body, self._hull.slices_of(body)
            self._plain_slices = plain(self._slices)
        return self._slices

    def add(self, posed: PosedJoints, body: Shaped, H: Floats, b: Floats, /) -> float:
        """See `Term`."""
        self.slices(body)
        cost: float = push_arms_out(
            posed.R, posed.joints, self._model.parents, self._plain_slices, self._plain_arms, self._information, H, b
        )  # fmt: skip
        return cost
