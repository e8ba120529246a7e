"""What a fit found: the state, and how far the pictures agree with it."""

from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import ARM_AREAS, N_AREAS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.positive_inverse import positive_inverse
from mocapd.types import Floats, Ints

_CONFIRMED, _CONFIRMED_PX = 0.4, 4.0  # share and number of the rendered pixels
_IN_SIGHT = 0.10  # an arm in sight takes at least this share of all that is visible


@dataclass(frozen=True, eq=False)  # no slots: a cached property is kept in __dict__
class Fit:
    """The fitted state; by area (A,) the rendered, matched and wrongly placed pixels; H (P,P): the
    information of the evidence alone on pose and shape; information (n_pose,n_pose): with what was known before;
    in_depth (A,): share of an area's pixels that are where depths are seen, 1 where none are; nearer_px: where something is
    seen well before all that is drawn; measured_cost: what the cost has of terms that were measured for another pose."""

    state: MotionState
    visible: Floats
    matched: Floats
    unexplained: Floats
    H: Floats
    cost: float
    information: Floats
    in_depth: Floats = field(default_factory=partial(np.ones, N_AREAS))
    nearer_px: float = 0.0
    measured_cost: float = 0.0

    @cached_property
    def covariance(self) -> Floats:
        """Of the pose (n_pose,n_pose), as the pictures and what was known before leave it."""
        return positive_inverse(self.information)

    @cached_property
    def visible_px(self) -> float:
        """All that was rendered."""
        return float(self.visible.sum())

    @cached_property
    def match(self) -> float:
        """Share of the rendered pixels whose label the pictures have."""
        return float(self.matched.sum() / max(self.visible_px, 1.0))

    @cached_property
    def explained(self) -> float:
        """Share of rendered and of wrongly placed picture pixels that agree: harder than `match`."""
        return float(self.matched.sum() / max(self.visible_px + self.unexplained.sum(), 1.0))

    @property
    def cost_for_any_pose(self) -> float:
        """Its cost where poses far from each other are compared."""
        return self.cost - self.measured_cost

    @cached_property
    def confirmed_arms(self) -> dict[str, float]:
        """0..1 by side: share of an arm that the pictures confirm; one out of sight is not."""
        in_sight = _IN_SIGHT * self.visible_px
        confirmed = {}
        for side, p in ARM_AREAS.items():
            asked = self.visible[p].sum() + self.unexplained[p].sum()
            confirmed[side] = float(
                (self.matched * self.in_depth)[p].sum() / (max(asked, in_sight) + 1.0)
            )
        return confirmed


def confirmed_parts(matched: Floats | Ints, visible: Floats | Ints) -> NDArray[np.bool_]:
    """Of which areas, or labels, so much of what is rendered is seen that it cannot be chance."""
    return (matched >= _CONFIRMED_PX) & (matched >= _CONFIRMED * visible)
