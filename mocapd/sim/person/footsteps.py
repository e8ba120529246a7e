"""Feet that stand still and step after the moving body, as a pure function of time."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.types import Floats, Skeleton

_STEP_S = 0.55  # about the time of one leisurely step
_SWING = 0.42  # share of a foot's cycle in the air


@dataclass(frozen=True, slots=True, eq=False)
class FootTrack:
    """Where one ankle stands: plants (N,3) x, z [m] and yaw [rad], one cycle after the other."""

    plants: Floats
    turn_rad: float  # gain of the yaw after N cycles
    cycle_s: float
    phase: float  # of the cycle, where the foot leaves the floor
    ankle_height_m: float

    def at(self, t_s: float) -> tuple[Floats, float]:
        """Ankle (3,) [m] and yaw of the foot [rad] at a time inside the loop."""
        cycle = t_s / self.cycle_s - self.phase
        k = int(np.floor(cycle))
        u = min((cycle - k) / _SWING, 1.0)
        a, b = self._plant(k), self._plant(k + 1)
        s = u * u * (3 - 2 * u)
        x, z, yaw = a + s * (b - a)
        moved = float(np.hypot(b[0] - a[0], b[1] - a[1])) + 0.12 * abs(b[2] - a[2])
        lift = min(0.35 * moved, 0.09) * np.sin(np.pi * u) ** 2
        return np.array([x, self.ankle_height_m + lift, z]), float(yaw)

    def _plant(self, k: int) -> Floats:
        loops, i = divmod(k, len(self.plants))
        plant: Floats = self.plants[i] + np.array([0.0, 0.0, loops * self.turn_rad])
        return plant


def foot_tracks(
    root: Callable[[float], Floats], skeleton: Skeleton, loop_s: float, turn_rad: float
) -> tuple[FootTrack, FootTrack]:
    """Left and right foot for a root track x, z, yaw, crouch of time; they step in turn."""
    n = max(1, round(loop_s / (2 * _STEP_S)))
    cycle_s = loop_s / n
    tracks = []
    for side, phase in (("left", 0.0), ("right", 0.5)):
        ankle = skeleton.rest_m[INDEX[side + "Foot"]]
        # feet stand a little wider than the hip joints, and turned out
        home = np.array([1.35 * ankle[0], ankle[2]])
        toe_out = np.sign(ankle[0]) * 0.12
        plants = []
        for k in range(n):
            # planted for where the body will be half-way through the time the foot stands
            t = (k + phase + 0.5 * (_SWING + 1.0)) * cycle_s - cycle_s
            x, z, yaw, _ = root(t)
            c, s = np.cos(yaw), np.sin(yaw)
            plants.append(
                [x + c * home[0] + s * home[1], z - s * home[0] + c * home[1], yaw + toe_out]
            )
        tracks.append(FootTrack(np.array(plants), turn_rad, cycle_s, phase, float(ankle[1])))
    return tracks[0], tracks[1]
