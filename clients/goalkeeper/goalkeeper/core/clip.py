"""The best save of a round, kept tick by tick for the slow-motion replay. Pure."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from goalkeeper.core.limbs import LimbPose
from goalkeeper.core.pitch import TICK_HZ
from mocapd.types import Floats

BEFORE_TICKS, AFTER_TICKS = int(0.9 * TICK_HZ), int(0.6 * TICK_HZ)
SLOWNESS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """Keeper and ball at one tick, in the goal's frame."""

    pose: LimbPose
    ball_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """moments: one a tick; contact: which of them is the save; merit: how good it was."""

    moments: tuple[Moment, ...]
    contact: int
    merit: float

    def at(self, tick: float) -> Moment:
        """Between two moments too."""
        tick = min(max(tick, 0.0), len(self.moments) - 1.0)
        whole = min(int(tick), len(self.moments) - 2)
        a, b, share = self.moments[whole], self.moments[whole + 1], tick - whole
        points_m = a.pose.points_m + share * (b.pose.points_m - a.pose.points_m)
        return Moment(
            LimbPose(points_m, a.pose.known & b.pose.known),
            a.ball_m + share * (b.ball_m - a.ball_m),
        )


class ClipRecorder:
    """Sees every tick of a round in which there is a ball; keeps the best save."""

    def __init__(self) -> None:
        self.best: Clip | None = None
        self._recent: deque[Moment] = deque(maxlen=BEFORE_TICKS + AFTER_TICKS)
        self._merit, self._left = 0.0, 0

    def saw(self, pose: LimbPose, ball_m: Floats) -> None:
        """One tick."""
        self._recent.append(Moment(pose, np.array(ball_m)))
        if self._left > 0:
            self._left -= 1
            if self._left == 0:
                contact = len(self._recent) - 1 - AFTER_TICKS
                self.best = Clip(tuple(self._recent), max(contact, 0), self._merit)

    def begin_shot(self) -> None:
        """What is before a shot is no part of its clip."""
        self._recent.clear()
        self._left = 0

    def saved(self, merit: float) -> None:
        """The newest tick was a save, of this merit."""
        if self.best is None or merit > self.best.merit:
            self._merit, self._left = merit, AFTER_TICKS


def merit_of_save(pose: LimbPose, place_m: Floats, speed_mps: float) -> float:
    """How good a save was: fast balls, far from the body's middle."""
    middle = 0.5 * (pose.point("hips") + pose.point("upperChest"))
    stretch_m = float(np.hypot(place_m[0] - middle[0], place_m[1] - middle[1]))
    return (0.2 + stretch_m) * speed_mps
