"""The flexible body in time: states, and the pure functions that lead from one to the next.

One frame of a tracker: `with_head`, `simulate`, then, after the particle filters, `with_points` and
`project_onto_constraints` with masses by `confident_masses`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.arrays import plain
from mocapd.geometry import rotations
from mocapd.published.hecht2009.mass_spring.body_points import (
    ELBOW,
    HEAD,
    LIMBS,
    N_POINTS,
    SHOULDER,
    WRIST,
    head_forward,
)
from mocapd.published.hecht2009.mass_spring.mass_spring_body import MassSpringBody
from mocapd.published.hecht2009.mass_spring.solver_kernels import (
    LIMITS_EVERY,
    advance,
    project,
)
from mocapd.types import Floats

# three seconds with the damping at which a body that hangs comes to rest soonest, twice its pendulum's frequency
_CALMING_PER_S, _CALMING_FRAMES = 7.0, 90
_NO_FLOOR_M = -math.inf  # its height where none is known


@dataclass(frozen=True, slots=True)
class SimulationParams:
    """step_s: the longest Verlet step, a frame takes as many as it needs: many short steps of few sweeps are stiffer than one
    long step of many (Macklin et al. 2019). most_s: of a longer gap between frames the rest is not simulated."""

    step_s: float = 1.0 / 120.0
    most_s: float = 0.25
    sweeps_per_step: int = 20
    projection_sweeps: int = 80
    # a projection lets springs give as in a step of this length: the time between measurements
    projection_s: float = 1.0 / 30.0
    # people's limbs swing out within a second, as muscles brake them
    damping_per_s: float = 3.0
    gravity_m_s2: float = 9.81
    # a fist at its quickest
    most_m_s: float = 12.0
    # of the head's way all other points go with it [Hecht et al. 2009, section III]
    head_share: float = 0.8


_USUAL = SimulationParams()


@dataclass(frozen=True, slots=True, eq=False)
class MassSpringState:
    """points_m (16,3) [m, world] and velocities_m_s (16,3), the way of the last Verlet step by its time."""

    points_m: Floats
    velocities_m_s: Floats


def inverse_masses(mass_kg: Floats) -> Floats:
    """(16,) [1/kg]; 0 for infinite ones, which only assignment moves."""
    return np.divide(1.0, mass_kg, out=np.zeros(len(mass_kg)), where=np.isfinite(mass_kg))


def confident_masses(
    base_kg: Floats, spread_m: Floats, variable_kg: float = 30.0, falloff_per_m: float = -12.0
) -> Floats:
    """m = m_base + m_variable exp(s sigma) for points with these filter spreads (16,) [m]; inf: without a filter.

    The paper calls sigma the variance; here it is the standard deviation, so that s < 0 is in 1/m.
    """
    masses: Floats = base_kg + variable_kg * np.exp(falloff_per_m * np.maximum(spread_m, 0.0))
    return masses


def resting(points_m: Floats) -> MassSpringState:
    """A state without motion."""
    points = np.array(points_m, dtype=float)
    return MassSpringState(points, np.zeros_like(points))


def with_head(
    body: MassSpringBody,
    state: MassSpringState,
    middle_m: Floats,
    params: SimulationParams = _USUAL,
) -> MassSpringState:
    """The head's middle at middle_m (3,), all other points moved by head_share of HEAD's motion; velocities unchanged."""
    head = middle_m - body.frusta.head_ahead_m * head_forward(state.points_m)
    points = state.points_m + params.head_share * (head - state.points_m[HEAD])
    points[HEAD] = head
    return replace(state, points_m=points)


def head_middle(body: MassSpringBody, state: MassSpringState) -> Floats:
    """Where the head's middle is (3,) [m]."""
    middle: Floats = state.points_m[HEAD] + body.frusta.head_ahead_m * head_forward(state.points_m)
    return middle


def with_points(state: MassSpringState, which: Sequence[int], points_m: Floats) -> MassSpringState:
    """Some points overwritten by points_m (K,3), as by the mean of a particle filter; velocities unchanged."""
    points = state.points_m.copy()
    points[list(which)] = points_m
    return replace(state, points_m=points)


def simulate(
    body: MassSpringBody,
    state: MassSpringState,
    dt_s: float,
    mass_kg: Floats | None = None,
    floor_m: float = _NO_FLOOR_M,
    params: SimulationParams = _USUAL,
) -> MassSpringState:
    """The state dt_s later: Verlet steps with gravity and damping, each projected.

    mass_kg (16,): the body's own unless given, inf for fixed points; floor_m: height of the floor. Time
    beyond params.most_s is not simulated.
    """
    dt = min(max(dt_s, 0.0), params.most_s)
    if dt == 0.0:
        return state
    points, velocities = state.points_m.copy(), state.velocities_m_s.copy()
    advance(
        points, velocities, inverse_masses(body.mass_kg if mass_kg is None else mass_kg),
        plain(body.constraints), plain(body.everybody), floor_m, dt,
        math.ceil(dt / params.step_s - 1e-6), params.sweeps_per_step, params.damping_per_s,
        params.gravity_m_s2, params.most_m_s,
    )  # fmt: skip
    return MassSpringState(points, velocities)


def project_onto_constraints(
    body: MassSpringBody,
    state: MassSpringState,
    mass_kg: Floats | None = None,
    floor_m: float = _NO_FLOOR_M,
    params: SimulationParams = _USUAL,
) -> MassSpringState:
    """The nearest state that the constraints allow; heavy points move least. No time passes, velocities are unchanged."""
    points = state.points_m[None].copy()
    project(
        points, np.arange(N_POINTS), state.points_m,
        inverse_masses(body.mass_kg if mass_kg is None else mass_kg), plain(body.constraints),
        plain(body.everybody), floor_m, params.projection_s, params.projection_sweeps, LIMITS_EVERY,
    )  # fmt: skip
    return replace(state, points_m=points[0])


def project_limb(
    body: MassSpringBody,
    limb: str,
    particles_m: Floats,
    points_m: Floats,
    mass_kg: Floats | None = None,
    floor_m: float = _NO_FLOOR_M,
    sweeps: int = 4,
    params: SimulationParams = _USUAL,
) -> Floats:
    """Particles (N,3,3) [m] of one of LIMBS, projected to states that are valid with the other points of points_m (16,3).

    Only the constraints that touch the three points are active; all other points stay [Hecht et al. 2009, section III.A].
    """
    out = np.array(particles_m, dtype=float)
    project(
        out, np.array(LIMBS[limb]), np.ascontiguousarray(points_m, dtype=float),
        inverse_masses(body.mass_kg if mass_kg is None else mass_kg), plain(body.constraints),
        plain(body.limbs[limb]), floor_m, params.projection_s, sweeps, min(2, sweeps),
    )  # fmt: skip
    return out


def relaxed_state(
    body: MassSpringBody,
    middle_m: Floats,
    facing_rad: float = 0.0,
    floor_m: float = _NO_FLOOR_M,
    params: SimulationParams = _USUAL,
) -> MassSpringState:
    """The body at rest under its head, arms and legs dangling.

    middle_m (3,): the head's middle; facing_rad: the body's turn about +Y from facing +Z.
    """
    points = body.rest_m.copy()
    for s in (0, 1):
        upper, lower = (
            np.linalg.norm(points[a[s]] - points[b[s]])
            for a, b in ((SHOULDER, ELBOW), (ELBOW, WRIST))
        )
        points[ELBOW[s]] = points[SHOULDER[s]] - [0.0, upper, 0.0]
        points[WRIST[s]] = points[ELBOW[s]] - [0.0, lower, 0.0]
    turn = rotations.exp(np.array([0.0, facing_rad, 0.0]))
    points = rotations.rotate(turn, points - points[HEAD])
    head = middle_m - body.frusta.head_ahead_m * head_forward(points)
    state = resting(points + head)
    calm = replace(params, damping_per_s=_CALMING_PER_S)
    for _ in range(_CALMING_FRAMES):
        state = simulate(body, state, 1.0 / 30.0, floor_m=floor_m, params=calm)
    return resting(state.points_m)
