"""Result of a fit: the state, and its agreement with the pictures."""

from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import ARM_AREAS, FOREARM_AREAS, N_AREAS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.positive_inverse import positive_inverse
from mocapd.types import Floats, Ints

_CONFIRMED, _CONFIRMED_PX = 0.4, 4.0  # share and number of the rendered pixels
_IN_SIGHT = 0.10  # an arm in sight takes at least this share of all that is visible
_FOREARM_IN_SIGHT = 0.03


@dataclass(frozen=True, eq=False)  # no slots: a cached property lives in __dict__
class Fit:
    """The fitted state; by area (A,) the rendered, matched and wrongly placed pixels; H (P,P): the
    information of the evidence alone on pose and shape; information (n_pose,n_pose): with the prior;
    in_depth (A,): share of an area's pixels at the stereo depth, 1 without depth; nearer_px: pixels well in front of the
    drawn body; measured_cost: part of the cost from terms that were measured at another pose."""

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
        """Of the pose (n_pose,n_pose), from the pictures and the prior."""
        return positive_inverse(self.information)

    @cached_property
    def visible_px(self) -> float:
        """All rendered pixels."""
        return float(self.visible.sum())

    @cached_property
    def match(self) -> float:
        """Share of the rendered pixels with the same label in the pictures."""
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
        """0..1 by side: share of an arm that the pictures confirm; 0 out of sight."""
        return {side: self._confirmed(p, _IN_SIGHT) for side, p in ARM_AREAS.items()}

    @cached_property
    def confirmed_to_hands(self) -> dict[str, float]:
        """The lesser, by side, of `confirmed_arms` and the same share of the forearm."""
        forearms = {
            side: self._confirmed(p, _FOREARM_IN_SIGHT) for side, p in FOREARM_AREAS.items()
        }
        return {side: min(share, forearms[side]) for side, share in self.confirmed_arms.items()}

    def _confirmed(self, areas: slice, in_sight: float) -> float:
        """in_sight: the share of all visible pixels that the areas take at least, in sight."""
        asked = self.visible[areas].sum() + self.unexplained[areas].sum()
        matched = (self.matched * self.in_depth)[areas].sum()
        return float(matched / (max(asked, in_sight * self.visible_px) + 1.0))


def confirmed_parts(matched: Floats | Ints, visible: Floats | Ints) -> NDArray[np.bool_]:
    """Areas, or labels, with more matched pixels than chance allows."""
    return (matched >= _CONFIRMED_PX) & (matched >= _CONFIRMED * visible)
