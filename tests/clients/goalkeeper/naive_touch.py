"""The swept test's slow twin: ball and keeper are looked at 32 times a tick, without asking how they move."""

from dataclasses import dataclass

import numpy as np

from goalkeeper.core.ball import OVER_LINE_Z_M
from goalkeeper.core.flight import BALL_RADIUS_M, Flight
from goalkeeper.core.limbs import INDEX, LIMBS, LimbPose
from goalkeeper.core.pitch import TICK_S
from mocapd.types import Floats

LOOKS = 32
NEAR_M = 1.3  # before the goal line; farther away no ball can touch a keeper of these tests
# Two surfaces may be this far apart, or in each other, and be called touching or not: TOUCH_M of the swept test,
# the sag of a path that it takes for straight within a tick (0.09 mm), and what lies between two looks.
GRAZING_M = 4e-4


@dataclass(frozen=True, slots=True)
class KeptTick:
    """A tick of one flight: from which time after the shot [s], and the keeper at its beginning and end."""

    from_s: float
    before: LimbPose
    now: LimbPose


def least_gap_m(flight: Flight, ticks: list[KeptTick]) -> float:
    """The least distance between the ball's surface and the keeper's, before the ball is over the line [m]."""
    near = [tick for tick in ticks if flight.at(tick.from_s + TICK_S)[2] <= NEAR_M]
    if not near:
        return np.inf
    starts, ends = ([INDEX[p] for p in points] for points in zip(*_ENDS, strict=True))
    radii_m = np.array([limb.radius_m for limb in LIMBS])
    shares = np.arange(LOOKS + 1) / LOOKS
    ball = _ball_m(flight, np.array([tick.from_s for tick in near])[:, None] + shares * TICK_S)
    before, now = (np.stack([pose.points_m for pose in poses])[:, None] for poses in _poses(near))
    points = before + shares[:, None, None] * (now - before)
    known = np.stack([tick.before.known & tick.now.known for tick in near])
    gaps = axis_distance_m(ball[:, :, None], points[:, :, starts], points[:, :, ends])
    gaps -= radii_m + BALL_RADIUS_M
    counts = (known[:, starts] & known[:, ends])[:, None] & (ball[..., 2] > OVER_LINE_Z_M)[
        ..., None
    ]
    return float(gaps[counts].min(initial=np.inf))


def _poses(ticks: list[KeptTick]) -> tuple[list[LimbPose], list[LimbPose]]:
    return [tick.before for tick in ticks], [tick.now for tick in ticks]


def _ball_m(flight: Flight, times_s: Floats) -> Floats:
    """Where the ball's centre is (...,3) at times after the shot (...): on the last arc that has begun."""
    out = np.empty((*times_s.shape, 3))
    for number, arc in enumerate(flight.arcs):
        on = (times_s >= arc.from_s) | (number == 0)
        d = (times_s[on] - arc.from_s)[:, None]
        out[on] = arc.position_m + d * arc.velocity_mps + 0.5 * d * d * arc.acceleration_mps2
    return out


_ENDS = [(limb.start, limb.end) for limb in LIMBS]


def axis_distance_m(at: Floats, a: Floats, b: Floats) -> Floats:
    """Distance of points (...,3) and line segments from a to b (...,3): beside the line, or from its nearer end."""
    ab, ap, bp = b - a, at - a, at - b
    beside = np.linalg.norm(np.cross(ab, ap), axis=-1) / np.linalg.norm(ab, axis=-1)
    nearer = np.minimum(np.linalg.norm(ap, axis=-1), np.linalg.norm(bp, axis=-1))
    within = ((ap * ab).sum(axis=-1) > 0) & ((bp * ab).sum(axis=-1) < 0)
    out: Floats = np.where(within, beside, nearer)
    return out
