"""A shot's way through the air: arcs of constant acceleration, known exactly at every time. Pure.

Gravity pulls down and spin sideways; a ball that bounces on its way has two arcs.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats

GRAVITY_MPS2 = 9.81
BALL_RADIUS_M = 0.105  # futsal, size 4
BOUNCE = 0.65  # of the speed towards the ground that a bounce gives back
_BOUNCE_AT = 0.75  # of the flight's time


@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """From from_s [s after the shot] on: position (3,) [m], velocity (3,) [m/s], acceleration (3,) [m/s²]."""

    from_s: float
    position_m: Floats
    velocity_mps: Floats
    acceleration_mps2: Floats

    def at(self, t_s: float) -> Floats:
        """Where the ball's centre is (3,) [m]."""
        d = t_s - self.from_s
        out: Floats = self.position_m + d * self.velocity_mps + 0.5 * d * d * self.acceleration_mps2
        return out


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """Arcs in the order of time; the last one goes on. duration_s: until the target."""

    arcs: tuple[Arc, ...]
    duration_s: float

    def arc_at(self, t_s: float) -> Arc:
        """The arc that holds at a time after the shot [s]."""
        return next((arc for arc in reversed(self.arcs) if arc.from_s <= t_s), self.arcs[0])

    def at(self, t_s: float) -> Floats:
        """Where the ball's centre is (3,) [m], t_s after the shot."""
        return self.arc_at(t_s).at(t_s)

    def velocity_at(self, t_s: float) -> Floats:
        """Its velocity (3,) [m/s]."""
        arc = self.arc_at(t_s)
        out: Floats = arc.velocity_mps + (t_s - arc.from_s) * arc.acceleration_mps2
        return out


def straight_flight(
    from_m: Floats, target_m: Floats, duration_s: float, bend_mps2: float
) -> Flight:
    """One arc that is at the target after duration_s; bend_mps2: how spin accelerates it along +X."""
    acceleration = np.array([bend_mps2, -GRAVITY_MPS2, 0.0])
    velocity = (target_m - from_m) / duration_s - 0.5 * duration_s * acceleration
    return Flight((Arc(0.0, from_m, velocity, acceleration),), duration_s)


def bouncing_flight(
    from_m: Floats, target_x_m: float, target_z_m: float, duration_s: float
) -> Flight:
    """A shot from the ground that bounces once and comes over x, z after duration_s, at the height that follows."""
    down = np.array([0.0, -GRAVITY_MPS2, 0.0])
    until_s = _BOUNCE_AT * duration_s
    velocity = np.array([target_x_m - from_m[0], 0.0, target_z_m - from_m[2]]) / duration_s
    rising = velocity + np.array([0.0, 0.5 * GRAVITY_MPS2 * until_s, 0.0])
    first = Arc(0.0, from_m, rising, down)
    again = velocity + np.array([0.0, BOUNCE * 0.5 * GRAVITY_MPS2 * until_s, 0.0])
    return Flight((first, Arc(until_s, first.at(until_s), again, down)), duration_s)
