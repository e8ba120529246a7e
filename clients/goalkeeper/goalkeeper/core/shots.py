"""Shots: where from, where to, how fast; drawn for a player's reach and level, the same for the same seed. Pure."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from goalkeeper.core.difficulty import Difficulty
from goalkeeper.core.flight import BALL_RADIUS_M, Flight, bouncing_flight, straight_flight
from goalkeeper.core.limbs import LimbPose
from goalkeeper.core.pitch import (
    GOAL_HEIGHT_M,
    GOAL_LINE_Z_M,
    GOAL_WIDTH_M,
    SHOT_FROM_X_M,
    SHOT_FROM_Z_M,
)
from goalkeeper.core.reach import Reach
from mocapd.types import Floats

_INSIDE_M = 0.05  # between ball and post at least
_STEP_ASIDE_M = (
    0.30  # what a player reaches beyond his outstretched arm by a step, at the full spread
)
_LEAST_ASIDE = 0.35  # of the width: at the middle nobody need move
_SHOULDERS_M = 1.15
_MOST_BEND_MPS2 = 9.0
BOUNCE_S = (0.65, 1.05)  # flight times in which a bouncing ball comes over the line at 0.2 to 0.4 m


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """launch_s: on the match's clock; target_m (3,): where it crosses the goal line; kind: in one word."""

    number: int
    launch_s: float
    flight: Flight
    target_m: Floats
    kind: str


class Shooter(Protocol):
    """Decides what is shot next."""

    def watch(self, t_s: float, pose: LimbPose | None) -> None:
        """Every tick, the keeper as he is seen [match's clock; world]."""

    def next_shot(self, number: int, now_s: float, difficulty: Difficulty, reach: Reach) -> Shot:
        """The shot after those that were, launched at now_s or later."""


class RandomShooter:
    """Anywhere within reach, by a seeded generator."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 1])

    def watch(self, t_s: float, pose: LimbPose | None) -> None:
        """What the keeper does is nothing to this one."""

    def next_shot(self, number: int, now_s: float, difficulty: Difficulty, reach: Reach) -> Shot:
        """Every number is drawn from the generator whatever the kind, so that shots after it stay the same."""
        aside, side, up, x, z, speed, trick, bend = self._rng.random(8)
        launch_s = now_s + difficulty.pause_s
        width_m, height_m = _reachable(difficulty, reach)
        share = _LEAST_ASIDE + (1.0 - _LEAST_ASIDE) * aside
        low_m = 0.9 - 0.6 * difficulty.spread
        high_m = _SHOULDERS_M + (height_m - _SHOULDERS_M) * np.sqrt(1.0 - share * share)
        target_m = np.array(
            [
                (-1 if side < 0.5 else 1) * share * width_m,
                low_m + up * (high_m - low_m),
                GOAL_LINE_Z_M,
            ]
        )
        near_m, far_m = SHOT_FROM_Z_M
        from_m = np.array(
            [SHOT_FROM_X_M * (2.0 * x - 1.0), BALL_RADIUS_M, near_m + z * (far_m - near_m)]
        )
        duration_s = float(from_m[2] - GOAL_LINE_Z_M) / (difficulty.speed_mps * (0.9 + 0.2 * speed))
        if trick < difficulty.trick_share:
            if BOUNCE_S[0] < duration_s < BOUNCE_S[1] and bend < 0.5:
                flight = bouncing_flight(from_m, target_m[0], GOAL_LINE_Z_M, duration_s)
                return Shot(number, launch_s, flight, flight.at(duration_s), "bouncer")
            bend_mps2 = _MOST_BEND_MPS2 * (2.0 * bend - 1.0)
            flight = straight_flight(from_m, target_m, duration_s, bend_mps2)
            return Shot(number, launch_s, flight, target_m, "curler")
        return Shot(
            number,
            launch_s,
            straight_flight(from_m, target_m, duration_s, 0.0),
            target_m,
            "straight",
        )


def _reachable(difficulty: Difficulty, reach: Reach) -> tuple[float, float]:
    """How far aside and how high shots go [m]: within reach and within the goal."""
    inside_m = BALL_RADIUS_M + _INSIDE_M
    width_m = difficulty.spread * (reach.side_m + _STEP_ASIDE_M)
    height_m = _SHOULDERS_M + difficulty.spread * (reach.up_m - _SHOULDERS_M)
    return min(width_m, 0.5 * GOAL_WIDTH_M - inside_m), min(height_m, GOAL_HEIGHT_M - inside_m)
