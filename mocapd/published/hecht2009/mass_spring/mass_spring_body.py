"""The flexible body of one shape: masses, springs, limits and cross-sections, ready for the kernels."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arrays import plain
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.published.hecht2009.mass_spring.angular_limits import hinges, swings
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    KNEE,
    LIMBS,
    N_POINTS,
    WRIST,
    rest_points,
)
from mocapd.published.hecht2009.mass_spring.frusta import Frusta, build_frusta, trunk_ellipses
from mocapd.published.hecht2009.mass_spring.solver_kernels import Active, PointConstraints
from mocapd.published.hecht2009.mass_spring.springs import COMPLIANCE, ENDS, spring_lengths
from mocapd.types import Floats, Ints, Skeleton

# Parts of the body's mass at the points, after the segments of Winter, Biomechanics of Human Movement, table 4.1: trunk
# 0.50 (shared by shoulders, waist, hips), arm 0.05, leg 0.16; the head's is not asked for.
_MASS_SHARES = np.array([0.0, 0.05, *[0.095, 0.025, 0.015, 0.10, 0.12, 0.08, 0.04] * 2])
_MASS_PER_STATURE3 = 13.0  # [kg/m^3]: 70 kg at 1.75 m (Rohrer)
_FLOOR_GIVE_M = 0.01
_ARMS = np.array([[ELBOW[s], WRIST[s]] for s in (0, 1)])
_PAIRS = np.array([KNEE, ANKLE])
# The least distance of left and right along the hip line: ankles pass each other closely when walking.
_KNEE_GAP_M, _ANKLE_GAP_M = 0.05, 0.03
# Farther from each other than that, across the hip line, legs may cross, which the paper never lets them: two filters on one
# leg are near to each other, crossed legs are not.
_PASSING_M = 0.12
_GAPS_M = np.array([[_KNEE_GAP_M, _PASSING_M], [_ANKLE_GAP_M, _PASSING_M]])


@dataclass(frozen=True, slots=True, eq=False)
class MassSpringBody:
    """A flexible body of sixteen points.

    rest_m (16,3): the T-pose; mass_kg (16,): the base masses, that of the head infinite; everybody: all constraints; limbs:
    those that touch each of LIMBS.
    """

    shape: BodyShape
    skeleton: Skeleton
    rest_m: Floats
    mass_kg: Floats
    frusta: Frusta
    constraints: PointConstraints
    everybody: Active
    limbs: dict[str, Active]


def build_body(shape: BodyShape) -> MassSpringBody:
    """The body of a shape, its springs at rest in the T-pose."""
    skeleton = skeleton_of(shape)
    rest = rest_points(shape, skeleton)
    mass = _MASS_SHARES * _MASS_PER_STATURE3 * shape.stature_m**3
    mass[HEAD] = np.inf
    constraints = PointConstraints(
        ENDS, spring_lengths(rest), COMPLIANCE, plain(swings()), plain(hinges()),
        trunk_ellipses(shape, skeleton, rest), _ARMS, _PAIRS, _GAPS_M, _clearance(shape, rest),
    )  # fmt: skip
    everybody = _active(frozenset(range(N_POINTS)))
    limbs = {name: _active(frozenset(limb)) for name, limb in LIMBS.items()}
    frusta = build_frusta(shape, skeleton, rest)
    return MassSpringBody(shape, skeleton, rest, mass, frusta, constraints, everybody, limbs)


def _clearance(shape: BodyShape, rest_m: Floats) -> Floats:
    """Least height of each point. Of the ankles: a little below their height in the T-pose, because floor and stature are
    accurate to a centimetre, for which a leg would bend by 15 degrees. All other points may lie on the floor."""
    out = np.full(N_POINTS, 0.03 * shape.stature_m)
    out[list(ANKLE)] = rest_m[list(ANKLE), 1] - _FLOOR_GIVE_M
    return out


def _active(points: frozenset[int]) -> Active:
    """The constraints that may move one of the points."""

    def touching(moved: Ints) -> Ints:
        rows = [k for k, ends in enumerate(moved.tolist()) if points & set(ends)]
        return np.array(rows, dtype=np.int64)

    return Active(
        touching(ENDS), touching(swings().points),
        touching(hinges().points[:, 1:]),  # a hinge moves its middle and its end
        touching(_ARMS), touching(_PAIRS), np.array(sorted(points)),
    )  # fmt: skip
