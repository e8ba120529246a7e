"""When a moving ball first touches one of many moving capsules, within one tick. Pure.

Ball and capsule ends move in straight lines during the tick, each at its own constant speed. The distance from
the ball's centre to a capsule's axis changes no faster than the ball moves against the faster end, so
a step of (distance - radii) / that speed never passes a contact: conservative advancement. Nothing tunnels,
however fast it is; two surfaces count as touching within TOUCH_M.
"""

from dataclasses import dataclass

import numpy as np

from goalkeeper.core.limbs import Bools
from mocapd.types import Floats

TOUCH_M = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Capsules:
    """C capsules over a tick: ends (C,3) at its beginning and at its end [m], radii_m (C,), present (C,): others
    are not there."""

    start_from_m: Floats
    start_to_m: Floats
    end_from_m: Floats
    end_to_m: Floats
    radii_m: Floats
    present: Bools


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """fraction: of the tick, 0..1; capsule: which; normal (3,): from its axis to the ball; surface_velocity_m
    (3,): how far its axis moves there in a whole tick."""

    fraction: float
    capsule: int
    normal: Floats
    surface_velocity_m: Floats


def first_contact(
    ball_from_m: Floats, ball_to_m: Floats, ball_radius_m: float, capsules: Capsules
) -> Contact | None:
    """The first touch in the tick; None: there is none."""
    limit_m = capsules.radii_m + ball_radius_m
    ball_move = ball_to_m - ball_from_m
    start_move = capsules.start_to_m - capsules.start_from_m
    end_move = capsules.end_to_m - capsules.end_from_m
    speed_m = np.sqrt(
        np.maximum(
            ((ball_move - start_move) ** 2).sum(axis=1), ((ball_move - end_move) ** 2).sum(axis=1)
        )
    )
    at = np.zeros(len(limit_m))
    going = capsules.present.copy()
    touched = np.full(len(limit_m), np.inf)
    while going.any():
        offset, _ = _offsets(at, ball_from_m, ball_move, capsules, start_move, end_move)
        gap_m = np.sqrt((offset**2).sum(axis=1)) - limit_m
        touches = going & (gap_m <= TOUCH_M)
        touched[touches] = at[touches]
        # what cannot touch before the tick ends, or before another does, is out
        going &= ~touches & (gap_m < speed_m * (1.0 - at)) & (at < touched.min())
        at = np.where(going, at + gap_m / np.maximum(speed_m, 1e-12), at)
    capsule = int(np.argmin(touched))
    if not np.isfinite(touched[capsule]):
        return None
    at[:] = touched[capsule]
    offset, along = _offsets(at, ball_from_m, ball_move, capsules, start_move, end_move)
    length_m = max(float(np.linalg.norm(offset[capsule])), 1e-9)
    share = along[capsule]
    return Contact(
        float(touched[capsule]),
        capsule,
        offset[capsule] / length_m,
        (1.0 - share) * start_move[capsule] + share * end_move[capsule],
    )


def _offsets(
    at: Floats,
    ball_from_m: Floats,
    ball_move: Floats,
    capsules: Capsules,
    start_move: Floats,
    end_move: Floats,
) -> tuple[Floats, Floats]:
    """From the nearest point of each axis to the ball (C,3), and where on the axis that is (C,) 0..1; `at` (C,):
    the part of the tick that has passed."""
    part = at[:, None]
    start = capsules.start_from_m + part * start_move
    axis = capsules.end_from_m + part * end_move - start
    to_ball = ball_from_m + part * ball_move - start
    squared = np.maximum((axis**2).sum(axis=1), 1e-12)
    along = np.clip((to_ball * axis).sum(axis=1) / squared, 0.0, 1.0)
    return to_ball - along[:, None] * axis, along
