"""Compiled Verlet steps and Gauss-Seidel sweeps over the constraints, for one body or for the particles of a limb."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.mass_spring.angular_limits import Hinges, Swings
from mocapd.published.hecht2009.mass_spring.constraint_kernels import (
    part_pairs,
    push_arms_out,
    span_frames,
    sweep_hinges,
    sweep_springs,
    sweep_swings,
)

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

LIMITS_EVERY = 4  # sweeps of the springs for one of all else: lengths are what takes long to agree


class PointConstraints(NamedTuple):
    """All constraints of a body with S springs.

    ends (S,2), lengths (S,) [m], compliance (S,) [m/N]; swings, hinges: see `angular_limits`; trunk (3,3): see
    `push_arms_out`; arms (2,2): elbow and wrist; pairs (2,2): left and right knees, ankles; gaps (2,2) [m]: see
    `part_pairs`; clearance (16,):
    least height of each point above the floor [m].
    """

    ends: Ints
    lengths: Array
    compliance: Array
    swings: Swings
    hinges: Hinges
    trunk: Array
    arms: Ints
    pairs: Ints
    gaps: Array
    clearance: Array


class Active(NamedTuple):
    """Which constraints are projected: rows of the tables of springs, swings, hinges, arms and pairs, and the points that the
    floor holds."""

    springs: Ints
    swings: Ints
    hinges: Ints
    arms: Ints
    pairs: Ints
    points: Ints


@kernel(error_model="numpy")
def project(
    particles: Array,
    moved: Ints,
    points: Array,
    inverse_mass: Array,
    constraints: PointConstraints,
    active: Active,
    floor_m: float,
    dt_s: float,
    iterations: int,
    every: int,
) -> None:
    """Move each particle (N,K,3) into a state that satisfies the active constraints, in place.

    moved (K,): which of the points (16,3) a particle stands for, all others are where `points` has them and do not move.
    iterations: sweeps of the springs, a multiple of `every`, after which all other constraints have theirs; floor_m: its
    height, -inf where it is not known; dt_s scales the give of springs.
    """
    ends, lengths, compliance, swings, hinges, trunk, arms, pairs, gaps, clearance = constraints
    springs, swing_rows, hinge_rows, arm_rows, pair_rows, held = active
    n_springs = lengths.shape[0]
    give, shares, multipliers = np.empty(n_springs), np.empty(n_springs), np.empty(n_springs)
    frames = np.empty((2, 3, 3))
    body = points.copy()
    w = np.zeros(points.shape[0])
    for i in range(moved.shape[0]):
        w[moved[i]] = inverse_mass[moved[i]]
    for k in range(springs.shape[0]):
        s = springs[k]
        give[s] = compliance[s] / (dt_s * dt_s)
        both = w[ends[s, 0]] + w[ends[s, 1]]
        shares[s] = 1.0 / (both + give[s]) if both > 0.0 else 0.0
    for p in range(particles.shape[0]):
        for i in range(moved.shape[0]):
            for r in range(3):
                body[moved[i], r] = particles[p, i, r]
        for s in range(n_springs):
            multipliers[s] = 0.0
        for n in range(iterations):
            sweep_springs(body, w, ends, lengths, give, shares, springs, multipliers)
            if (n + 1) % every != 0:
                continue
            span_frames(body, frames)
            sweep_swings(body, w, swings, swing_rows, frames)
            sweep_hinges(body, w, hinges, hinge_rows, frames)
            part_pairs(body, w, pairs, gaps, pair_rows, frames)
            push_arms_out(body, w, arms, arm_rows, trunk, frames)
            for k in range(held.shape[0]):
                i = held[k]
                if w[i] > 0.0 and body[i, 1] < floor_m + clearance[i]:
                    body[i, 1] = floor_m + clearance[i]
        for i in range(moved.shape[0]):
            for r in range(3):
                particles[p, i, r] = body[moved[i], r]


@kernel
def advance(
    points: Array,
    velocities: Array,
    inverse_mass: Array,
    constraints: PointConstraints,
    active: Active,
    floor_m: float,
    dt_s: float,
    steps: int,
    iterations: int,
    damping_per_s: float,
    gravity_m_s2: float,
    most_m_s: float,
) -> None:
    """`steps` Verlet steps of together dt_s, in place: x + (x - x_before) + a h^2, then the projection.

    velocities (16,3): (x - x_before) / h of the step before, so that h may differ from step to step. They fade with
    exp(-damping h); none is faster than most_m_s, for a large correction of a place is no motion.
    """
    h = dt_s / steps
    before = np.empty_like(points)
    all_points = np.arange(points.shape[0])
    whole = points.reshape(1, points.shape[0], 3)
    kept = np.exp(-damping_per_s * h)
    for _ in range(steps):
        for i in range(points.shape[0]):
            for r in range(3):
                before[i, r] = points[i, r]
            if inverse_mass[i] == 0.0:
                continue
            for r in range(3):
                points[i, r] += h * kept * velocities[i, r]
            points[i, 1] -= gravity_m_s2 * h * h
        project(
            whole, all_points, before, inverse_mass, constraints, active, floor_m, h, iterations,
            LIMITS_EVERY,
        )  # fmt: skip
        for i in range(points.shape[0]):
            speed2 = 0.0
            for r in range(3):
                velocities[i, r] = (points[i, r] - before[i, r]) / h
                speed2 += velocities[i, r] * velocities[i, r]
            if speed2 > most_m_s * most_m_s:
                f = most_m_s / np.sqrt(speed2)
                for r in range(3):
                    velocities[i, r] *= f
