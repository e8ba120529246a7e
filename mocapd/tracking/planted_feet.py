"""Detects planted feet: a foot that has stayed in one place on the floor for a while is fixed there.

Cameras that look from one side hardly tell how far away a foot is: found anew in each frame set, a foot that stands wanders
by several centimetres along their line of sight, and little across it. There it may, and its place is a mean over longer.

Early poses err, and a foot that is held does not show where it would go. So it is held the more firmly the longer it stands.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.clock import seconds
from mocapd.types import Floats, Ints

_FEET = np.array([[INDEX[side + bone] for bone in ("Foot", "Toes")] for side in SIDES])  # (2,2)


@dataclass(frozen=True, slots=True)
class PlantedFeetParams:
    """Hysteresis of a foot's contact with the floor.

    Planted: ankle and toes have stayed within near_m of their mean place, and within low_m of their height in the
    T-pose, for still_s. The place is their mean, and follows them with time constant follows_s later; they are held there
    firmly after firm_s. Lifted: one of them is farther than far_m from the place or higher than high_m. Before cameras that
    look from one side: for still_from_one_side_s, and along their line of sight distances count as deep times less.
    """

    near_m: float = 0.025
    low_m: float = 0.03
    still_s: float = 0.3
    still_from_one_side_s: float = 0.9
    deep: float = 3.0
    follows_s: float = 3.0
    firm_s: float = 3.0
    far_m: float = 0.05
    high_m: float = 0.06
    expires_s: float = 1.0  # over which a pose is predicted


class PlantedFeet:
    """Tracks each foot's mean place and how long it has stayed there."""

    def __init__(self, rest_m: Floats, params: PlantedFeetParams) -> None:
        """rest_m (J,3): joints of the T-pose on the floor [m]."""
        self._params, self._rest_height_m = params, rest_m[_FEET, 1]
        self.reset()

    def reset(self) -> None:
        """Forgets all feet."""
        self._t_ns: int | None = None
        self._mean_m = np.zeros((2, 2, 2))  # of each foot's joints, along x and z
        self._still_s = np.zeros(2)  # for how long each foot has been there
        self._planted_from_s = self._params.still_s

    def expire(self, t_ns: int) -> None:
        """Forgets all feet where the last fit is too old at t_ns: the next body is another one, or stands elsewhere."""
        if self._t_ns is not None and seconds(t_ns - self._t_ns) > self._params.expires_s:
            self.reset()

    @property
    def joints(self) -> Ints:
        """Joints (F,) of the planted feet."""
        out: Ints = _FEET[self._is_planted].ravel()
        return out

    @property
    def places_m(self) -> Floats:
        """Their places (F,2), x and z [m, world]."""
        out: Floats = self._mean_m[self._is_planted].reshape(-1, 2)
        return out

    @property
    def firmness(self) -> Floats:
        """How firmly they are held there (F,), up to 1: the variance of a mean falls with the time it is taken over."""
        share = np.minimum(self._still_s / self._params.firm_s, 1.0)
        out: Floats = np.repeat(share[self._is_planted], 2)
        return out

    @property
    def _is_planted(self) -> NDArray[np.bool_]:
        return np.asarray(self._still_s >= self._planted_from_s)

    def update(self, joints_m: Floats, t_ns: int, sight: Floats | None = None) -> None:
        """Updates both feet from the joints (J,3) [m] of a new fit. sight (3,): the line of sight of cameras that look from
        one side."""
        self.expire(t_ns)
        p = self._params
        self._planted_from_s = p.still_s if sight is None else p.still_from_one_side_s
        dt_s = 0.0 if self._t_ns is None else seconds(t_ns - self._t_ns)
        self._t_ns = t_ns
        feet_m = joints_m[_FEET]
        place_m, height_m = feet_m[..., [0, 2]], feet_m[..., 1] - self._rest_height_m
        way_m = place_m - self._mean_m
        if sight is not None:
            level = sight[[0, 2]] / max(float(np.linalg.norm(sight[[0, 2]])), 1e-6)
            way_m -= (1.0 - 1.0 / p.deep) * (way_m @ level)[..., None] * level
        away_m = np.linalg.norm(way_m, axis=-1).max(axis=1)
        planted = self._is_planted
        stays = np.where(planted, away_m <= p.far_m, away_m <= p.near_m)
        stays &= np.where(
            planted, height_m.max(axis=1) <= p.high_m, height_m.max(axis=1) <= p.low_m
        )
        self._still_s = np.where(stays, self._still_s + dt_s, 0.0)
        lasts_s = np.clip(self._still_s, 1e-3, p.follows_s)
        share = np.where(stays, np.minimum(dt_s / lasts_s, 1.0), 1.0)
        self._mean_m += share[:, None, None] * (place_m - self._mean_m)
