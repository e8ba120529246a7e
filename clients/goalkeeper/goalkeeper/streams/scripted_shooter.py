"""Shoots to where the demo's person reaches, when she does."""

import numpy as np

from goalkeeper.core.difficulty import Difficulty
from goalkeeper.core.flight import BALL_RADIUS_M, Flight, straight_flight
from goalkeeper.core.limbs import LimbPose
from goalkeeper.core.pitch import GOAL_LINE_Z_M, SHOT_FROM_Z_M
from goalkeeper.core.reach import Reach, is_t_pose
from goalkeeper.core.shots import Shot
from goalkeeper.streams.demo_script import FORWARD_M, LOOP_S, POSED_S, SCRIPT, Reaching
from mocapd.types import Floats

_LEFT_AFTER_S = 0.12  # how long after the hold's end arms no longer look like a T
_HELD_S = 0.8  # of a T-pose that is the loop's beginning


class ScriptedShooter:
    """Knows where in the loop the person is from the end of her T-pose; until one was seen, takes now for it."""

    def __init__(self) -> None:
        self._began_s: float | None = None  # of a loop, on the match's clock
        self._posed_since_s: float | None = None

    def watch(self, t_s: float, pose: LimbPose | None) -> None:
        """Looks out for the T-pose."""
        posed = pose is not None and is_t_pose(pose)
        if posed and self._posed_since_s is None:
            self._posed_since_s = t_s
        if not posed and self._posed_since_s is not None:
            if pose is not None and t_s - self._posed_since_s > _HELD_S:
                self._began_s = t_s - POSED_S - _LEFT_AFTER_S
            self._posed_since_s = None

    def next_shot(
        self,
        number: int,
        now_s: float,
        difficulty: Difficulty,
        reach: Reach,  # noqa: ARG002 (the script knows hers)
    ) -> Shot:
        """To the next place in the script that can still be reached in time."""
        began_s = now_s if self._began_s is None else self._began_s
        from_m = np.array([(-1.5, 0.0, 1.5)[number % 3], BALL_RADIUS_M, SHOT_FROM_Z_M[0]])
        until_s = (from_m[2] - FORWARD_M) / difficulty.speed_mps
        loop = max(0, int((now_s - began_s) // LOOP_S))
        arrivals = [
            (began_s + (loop + k) * LOOP_S + one.at_s, one) for k in (0, 1) for one in SCRIPT
        ]
        at_s, one = next(pair for pair in arrivals if pair[0] - until_s >= now_s)
        flight = _through(from_m, one, float(until_s))
        return Shot(number, at_s - until_s, flight, flight.at(flight.duration_s), "straight")


def _through(from_m: Floats, one: Reaching, until_s: float) -> Flight:
    """A flight through the place where the hand is, and on to the line."""
    dx_m, dy_m = one.miss_m
    hand_m = np.array([one.x_m + one.side_m + dx_m, one.y_m + dy_m, FORWARD_M])
    first = straight_flight(from_m, hand_m, until_s, 0.0)
    whole_s = until_s * (from_m[2] - GOAL_LINE_Z_M) / (from_m[2] - FORWARD_M)
    return Flight(first.arcs, float(whole_s))
