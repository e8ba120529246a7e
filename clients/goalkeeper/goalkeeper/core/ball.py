"""The ball of one shot, tick by tick: in flight until it is saved or over the line, loose after that. Pure."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from goalkeeper.core.flight import BALL_RADIUS_M, BOUNCE, GRAVITY_MPS2
from goalkeeper.core.limbs import ENDS, RADII_M, STARTS, LimbPose, known_limbs
from goalkeeper.core.pitch import GOAL_DEPTH_M, GOAL_LINE_Z_M, TICK_S
from goalkeeper.core.shots import Shot
from goalkeeper.core.sweep import TOUCH_M, Capsules, Contact, first_contact
from mocapd.types import Floats

# The whole ball over the line.
OVER_LINE_Z_M = GOAL_LINE_Z_M - BALL_RADIUS_M
_THICKEST_M = float(RADII_M.max()) + TOUCH_M
_REBOUND = 0.45  # of the speed against the limb
_LEAST_AWAY_MPS = 1.5  # from the goal, after a save
_NET_STOPS = 0.25  # of the speed that is left in the net
_GROUND_KEEPS = 0.985  # of the speed along the ground, a tick


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """How a shot ended: saved by a limb (its place in LIMBS), or a goal (-1); how fast it was [m/s]; where [m]."""

    limb: int
    speed_mps: float
    place_m: Floats

    @property
    def saved(self) -> bool:
        """Whether a limb stopped it."""
        return self.limb >= 0


@dataclass(frozen=True, slots=True, eq=False)
class LooseBall:
    """Position [m] and velocity [m/s] (3,) each."""

    position_m: Floats
    velocity_mps: Floats

    def stepped(self) -> "LooseBall":
        """A tick later: gravity, ground, net."""
        velocity = self.velocity_mps - np.array([0.0, GRAVITY_MPS2 * TICK_S, 0.0])
        position = self.position_m + TICK_S * velocity
        if position[1] < BALL_RADIUS_M:
            position[1] = BALL_RADIUS_M
            velocity = velocity * np.array([_GROUND_KEEPS, -BOUNCE, _GROUND_KEEPS])
        back_m = GOAL_LINE_Z_M - GOAL_DEPTH_M + BALL_RADIUS_M
        if position[2] < back_m:
            position[2] = back_m
            velocity = velocity * np.array([_NET_STOPS, _NET_STOPS, -0.1])
        return LooseBall(position, velocity)


class ShotBall:
    """One shot's ball: `step` it once a tick from its launch on."""

    def __init__(self, shot: Shot) -> None:
        self.shot = shot
        self.outcome: Outcome | None = None
        self._ticks = self._ended_tick = 0
        self._loose: LooseBall | None = None

    @property
    def position_m(self) -> Floats:
        """The ball's centre (3,) now [m]."""
        if self._loose is not None:
            return self._loose.position_m
        return self.shot.flight.at(self._ticks * TICK_S)

    @property
    def since_launch_s(self) -> float:
        """How long ago it was shot [s]."""
        return self._ticks * TICK_S

    @property
    def since_outcome_s(self) -> float:
        """How long ago the shot ended [s]; 0 while it has not."""
        return 0.0 if self.outcome is None else (self._ticks - self._ended_tick) * TICK_S

    def step(self, before: LimbPose, now: LimbPose) -> Outcome | None:
        """One tick, in which the keeper moves from one pose to the other; the outcome in the tick in which it is one."""
        self._ticks += 1
        if self._loose is not None:
            self._loose = self._loose.stepped()
            return None
        from_s, to_s = (self._ticks - 1) * TICK_S, self._ticks * TICK_S
        for begin_s, end_s in _pieces(self.shot, from_s, to_s):
            outcome = self._piece(
                begin_s,
                end_s,
                _between(before, now, (begin_s - from_s) / TICK_S),
                _between(before, now, (end_s - from_s) / TICK_S),
            )
            if outcome is not None:
                self.outcome, self._ended_tick = outcome, self._ticks
                return outcome
        return None

    def _piece(
        self, begin_s: float, end_s: float, before: LimbPose, now: LimbPose
    ) -> Outcome | None:
        flight = self.shot.flight
        from_m, to_m = flight.at(begin_s), flight.at(end_s)
        contact = None
        if min(from_m[2], to_m[2]) < _nearest_z_m(before, now):
            contact = first_contact(from_m, to_m, BALL_RADIUS_M, swept_capsules(before, now))
        over = 2.0  # the part of the piece after which the ball is in the goal; more than 1: not in this one
        if to_m[2] <= OVER_LINE_Z_M:
            over = float((from_m[2] - OVER_LINE_Z_M) / (from_m[2] - to_m[2]))
        velocity = flight.velocity_at(end_s)
        speed_mps = float(np.linalg.norm(velocity))
        if contact is not None and contact.fraction < over:
            place_m = from_m + contact.fraction * (to_m - from_m)
            surface_mps = contact.surface_velocity_m / max(end_s - begin_s, 1e-9)
            self._loose = LooseBall(place_m, _rebound(velocity, contact, surface_mps))
            return Outcome(contact.capsule, speed_mps, place_m)
        if over <= 1.0:
            self._loose = LooseBall(to_m, velocity)
            return Outcome(-1, speed_mps, to_m)
        return None


def _nearest_z_m(before: LimbPose, now: LimbPose) -> float:
    """A ball farther out than this touches nothing: most ticks of a flight are over with that."""
    farthest_out = max(float(before.points_m[:, 2].max()), float(now.points_m[:, 2].max()))
    return farthest_out + _THICKEST_M + BALL_RADIUS_M


def swept_capsules(before: LimbPose, now: LimbPose) -> Capsules:
    """All limbs that are known at both ends of a motion."""
    a, b = before.points_m, now.points_m
    present = known_limbs(before) & known_limbs(now)
    return Capsules(a[STARTS], b[STARTS], a[ENDS], b[ENDS], RADII_M, present)


def _pieces(shot: Shot, from_s: float, to_s: float) -> list[tuple[float, float]]:
    """The tick, cut where an arc begins: a bounce is no straight line."""
    cuts = [arc.from_s for arc in shot.flight.arcs if from_s < arc.from_s < to_s]
    times = [from_s, *cuts, to_s]
    return list(pairwise(times))


def _between(before: LimbPose, now: LimbPose, share: float) -> LimbPose:
    if share <= 0.0:
        return before
    if share >= 1.0:
        return now
    return replace(before, points_m=before.points_m + share * (now.points_m - before.points_m))


def _rebound(velocity_mps: Floats, contact: Contact, surface_mps: Floats) -> Floats:
    """The velocity after a save: thrown back from the limb as it moves, and always away from the goal."""
    against_mps = float((velocity_mps - surface_mps) @ contact.normal)
    out: Floats = velocity_mps - (1.0 + _REBOUND) * min(against_mps, 0.0) * contact.normal
    out = 0.6 * out
    out[2] = max(out[2], _LEAST_AWAY_MPS)
    return out
