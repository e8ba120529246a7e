"""The hypothesis of a twisted leg: a standing leg whose foot points where no foot can, with the foot straight ahead.

A leg that hangs looks alike however it turns about itself, but for its foot. When the person turns round before cameras that
are close to each other, the fit may leave the foot behind: it then points backwards.
"""

from dataclasses import replace

import numpy as np

from mocapd.body.joint_limits import X, Y, Z, from_swing_twist, swing_twist
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit, cheapest, refits
from mocapd.types import Floats

_EVERY_S = 0.1
_ITERATIONS = 4
# of the foot from the pelvis's forward direction [rad]; 0.1 % of recorded legs that hang are beyond 49 and 80 degrees
_INWARDS_RAD, _OUTWARDS_RAD = np.radians(60.0), np.radians(90.0)
_MOST_COST = 10.0  # of the straight foot, beyond the twisted one's [disagreeing pixels]
_BONES = np.array(
    [[INDEX[side + bone] for side in SIDES] for bone in ("UpperLeg", "LowerLeg", "Foot")]
)
_OUTWARDS = np.array([1.0, -1.0])  # along x, of SIDES
_HANGING_RAD = 0.6  # swing of the thigh and flexion of the knee below which a leg hangs


class TwistedLegs:
    """See PoseHypothesis. The pictures must not clearly deny the straight foot; they need not confirm it."""

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        if not at.ticks.due(_EVERY_S):
            return now
        state = now.fit.state
        starts = [
            (replace(state, local_xyzw=with_foot_ahead(state.local_xyzw, side)), (f"{side}_leg",))
            for side in twisted_sides(state.local_xyzw)
        ]
        return cheapest(now, refits(now, at, starts, _ITERATIONS), -_MOST_COST)


def twisted_sides(local_xyzw: Floats) -> list[str]:
    """The sides of legs that hang and whose foot points where no foot can; local_xyzw (J,4): relative to the parents."""
    thighs, shanks, feet = local_xyzw[_BONES]
    from_foot = rotations.multiply(rotations.multiply(thighs, shanks), feet)
    ahead = rotations.rotate(from_foot, np.array([0.0, 0.0, 1.0]))
    outwards_rad = np.arctan2(_OUTWARDS * ahead[:, 0], ahead[:, 2])
    beyond = (outwards_rad < -_INWARDS_RAD) | (outwards_rad > _OUTWARDS_RAD)
    return [SIDES[i] for i in np.flatnonzero(beyond) if _hangs(thighs[i], shanks[i])]


def _hangs(thigh_xyzw: Floats, shank_xyzw: Floats) -> bool:
    swing_rad, knee_rad = swing_twist(thigh_xyzw, Y), swing_twist(shank_xyzw, Y)
    return bool(max(np.hypot(swing_rad[X], swing_rad[Z]), abs(knee_rad[X])) < _HANGING_RAD)


def with_foot_ahead(local_xyzw: Floats, side: str) -> Floats:
    """The pose (J,4) with no bone of this leg turned about the leg's own length."""
    out = local_xyzw.copy()
    for bone, axis in zip(_BONES[:, SIDES.index(side)], (Y, Y, Z), strict=True):
        angles = swing_twist(local_xyzw[bone], axis)
        angles[Y] = 0.0
        out[bone] = from_swing_twist(angles, axis)
    return out
