"""The flexible body moves as a body does, whatever pushes it."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.shape import LOWER_FACTOR_SD, BodyShape, mean_shape
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    HIP,
    KNEE,
    LIMBS,
    N_POINTS,
    SHOULDER,
    WRIST,
)
from mocapd.published.hecht2009.mass_spring.mass_spring_body import MassSpringBody, build_body
from mocapd.published.hecht2009.mass_spring.simulation import (
    MassSpringState,
    SimulationParams,
    confident_masses,
    head_middle,
    project_onto_constraints,
    relaxed_state,
    resting,
    simulate,
    with_head,
    with_points,
)
from mocapd.published.hecht2009.mass_spring.springs import COMPLIANCE, spring_lengths
from mocapd.types import Floats
from tests.published.hecht2009.mass_spring.naive_constraints import (
    MIRROR,
    deepest_in_trunk_m,
    legs_too_near_m,
    unit,
    worst_angle_rad,
)

MIDDLE_M = np.array([0.3, 1.63, 0.5])
BODY = build_body(mean_shape(1.75))
# Bones do not give; the trunk gives millimetres at rest, and centimetres where people would be hurt.
BONES = COMPLIANCE == 0.0
BONE_GIVE_M, TRUNK_GIVE_M = 0.006, 0.04
OF_SIDES = np.array([-1.0, 1.0, 1.0])

seeds = st.integers(0, 2**32 - 1)
quick = settings(max_examples=25, deadline=None)


@cache  # not at import, where each of several processes would compile what it takes
def at_rest() -> MassSpringState:
    """The body with its middle at MIDDLE_M; nobody may change it."""
    return relaxed_state(BODY, MIDDLE_M)


def strain_m(body: MassSpringBody, points: Floats) -> Floats:
    return np.abs(spring_lengths(points) - body.constraints.lengths)


def impulse(seed: int, most_m_s: float = 5.0) -> Floats:
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(N_POINTS, 3))
    speed = most_m_s * rng.uniform(size=(N_POINTS, 1))
    out: Floats = speed * way / np.linalg.norm(way, axis=1, keepdims=True)
    return out


def mirrored(points: Floats) -> Floats:
    out: Floats = (points * OF_SIDES)[MIRROR]
    return out


def assert_valid(body: MassSpringBody, points: Floats) -> None:
    assert np.isfinite(points).all()
    strain = strain_m(body, points)
    assert strain[BONES].max() < BONE_GIVE_M
    assert strain[~BONES].max() < TRUNK_GIVE_M
    assert np.degrees(worst_angle_rad(body, points)) < 2.0
    assert deepest_in_trunk_m(body, points) < 0.003
    assert legs_too_near_m(body, points) < 0.003


@quick
@given(seeds, st.floats(0.005, 0.1))
def test_no_impulse_breaks_it(seed: int, dt_s: float) -> None:
    start = at_rest()
    state = MassSpringState(start.points_m, impulse(seed))
    for _ in range(15):
        state = simulate(BODY, state, dt_s)
        assert_valid(BODY, state.points_m)
        assert (state.points_m[HEAD] == start.points_m[HEAD]).all()
    assert np.linalg.norm(state.velocities_m_s, axis=1).max() <= SimulationParams().most_m_s + 1e-9


def test_a_far_correction_is_no_motion() -> None:
    start = at_rest()
    torn = with_points(start, [WRIST[0]], start.points_m[[WRIST[0]]] + [0.9, 0.3, 0.4])
    after = simulate(BODY, torn, SimulationParams().step_s)
    assert np.linalg.norm(after.points_m - torn.points_m, axis=1).max() > 0.3
    speeds = np.linalg.norm(after.velocities_m_s, axis=1)
    assert speeds.max() <= SimulationParams().most_m_s + 1e-9
    assert strain_m(BODY, after.points_m)[BONES].max() < BONE_GIVE_M


@quick
@given(seeds)
def test_it_comes_to_rest_again(seed: int) -> None:
    state = MassSpringState(at_rest().points_m, impulse(seed))
    for _ in range(120):
        state = simulate(BODY, state, 1.0 / 30.0)
    # it may turn about its neck, and slowly does
    assert np.linalg.norm(state.velocities_m_s, axis=1).max() < 0.6
    heights = state.points_m[:, 1] - at_rest().points_m[:, 1]
    assert np.abs(heights[[*WRIST, *ANKLE]]).max() < 0.05
    # and no part of the trunk is left twisted
    across = [unit(state.points_m[a] - state.points_m[b]) for a, b in (SHOULDER, HIP)]
    assert np.degrees(np.arccos(across[0] @ across[1])) < 3.0


@quick
@given(seeds, st.sampled_from(sorted(LIMBS)), st.floats(0.0, 0.25))
def test_a_limb_may_be_put_anywhere(seed: int, limb: str, far_m: float) -> None:
    which, start = list(LIMBS[limb]), at_rest()
    offset = np.random.default_rng(seed).normal(size=(3, 3)) * far_m / np.sqrt(3.0)
    sure = np.where(np.isin(np.arange(N_POINTS), which), 0.02, np.inf)
    state = with_points(start, which, start.points_m[which] + offset)
    state = project_onto_constraints(BODY, state, confident_masses(BODY.mass_kg, sure))
    assert np.isfinite(state.points_m).all()
    assert (state.velocities_m_s == 0.0).all()
    assert strain_m(BODY, state.points_m)[BONES].max() < BONE_GIVE_M
    assert np.degrees(worst_angle_rad(BODY, state.points_m)) < 5.0
    for _ in range(3):
        state = simulate(BODY, state, 1.0 / 30.0)
    assert_valid(BODY, state.points_m)


@pytest.mark.parametrize("broken", [0.0, 1e-3])
def test_points_in_one_place_find_apart(broken: float) -> None:
    at = np.tile(MIDDLE_M, (N_POINTS, 1))
    at[1:] += broken * np.random.default_rng(0).normal(size=(N_POINTS - 1, 3))
    state = resting(at)
    for _ in range(60):
        state = simulate(BODY, state, 1.0 / 30.0)
        assert np.isfinite(state.points_m).all()


@pytest.mark.parametrize("floor_m", [-np.inf, 0.0])
def test_the_relaxed_body_stays_as_it_is(floor_m: float) -> None:
    start = state = relaxed_state(BODY, MIDDLE_M, floor_m=floor_m)
    for _ in range(30):
        state = simulate(BODY, state, 1.0 / 30.0, floor_m=floor_m)
    assert np.abs(state.points_m - start.points_m).max() < 1e-3


@pytest.mark.parametrize("facing_rad", [0.0, np.pi / 2, -2.0])
def test_relaxed_arms_and_legs_dangle_and_the_face_looks_where_it_should(
    facing_rad: float,
) -> None:
    state = relaxed_state(BODY, MIDDLE_M, facing_rad)
    p = state.points_m
    assert np.linalg.norm(head_middle(BODY, state) - MIDDLE_M) < 1e-3
    forward = np.array([np.sin(facing_rad), 0.0, np.cos(facing_rad)])
    across = unit(p[SHOULDER[0]] - p[SHOULDER[1]])
    assert np.abs(across - np.cross([0.0, 1.0, 0.0], forward)).max() < 1e-3
    down = np.array([0.0, -1.0, 0.0])
    for upper, lower in ((SHOULDER, ELBOW), (ELBOW, WRIST), (HIP, KNEE), (KNEE, ANKLE)):
        for s in (0, 1):
            assert unit(p[lower[s]] - p[upper[s]]) @ down > np.cos(np.radians(6.0))
    # as tall as the body stands
    sunk = (p - p[HEAD] - BODY.rest_m + BODY.rest_m[HEAD])[list(ANKLE), 1]
    assert np.abs(sunk).max() < 0.015
    assert strain_m(BODY, p).max() < 0.01


@quick
@given(seeds)
def test_left_and_right_are_alike(seed: int) -> None:
    start = at_rest().points_m - MIDDLE_M
    v = impulse(seed)
    v[HEAD] = 0.0
    here = simulate(BODY, MassSpringState(start, v), 1.0 / 30.0)
    there = simulate(BODY, MassSpringState(mirrored(start), mirrored(v)), 1.0 / 30.0)
    assert np.abs(here.points_m - mirrored(there.points_m)).max() < 5e-3


@quick
@given(seeds, st.sampled_from([2, 3, 4, 12]))
def test_the_frame_rate_does_not_matter(seed: int, parts: int) -> None:
    start = MassSpringState(at_rest().points_m, impulse(seed))
    whole = simulate(BODY, start, 0.1)
    state = start
    for _ in range(parts):
        state = simulate(BODY, state, 0.1 / parts)
    # twelve steps of the same length each, whoever asks for them
    assert np.abs(state.points_m - whole.points_m).max() < 1e-6


@pytest.mark.parametrize("step_s", [1 / 60, 1 / 90, 1 / 240])
def test_falling_arms_fall_as_fast_in_steps_of_another_length(step_s: float) -> None:
    # a step's length matters by what numbers damp; the swing of a straight arm has a closed form to compare with
    start = resting(BODY.rest_m)
    fallen = [
        simulate(BODY, start, 0.25, params=SimulationParams(step_s=s)).points_m
        for s in (1 / 120, step_s)
    ]
    assert (start.points_m[list(WRIST), 1] - fallen[0][list(WRIST), 1] > 0.12).all()
    assert np.abs(fallen[0] - fallen[1]).max() < 0.03


def test_what_falls_freely_falls_by_half_g_t_squared() -> None:
    body_free = np.where(np.isinf(BODY.mass_kg), 5.0, BODY.mass_kg)
    params = SimulationParams(damping_per_s=0.0)
    state = simulate(BODY, at_rest(), 0.2, body_free, params=params)
    fallen = (at_rest().points_m - state.points_m)[:, 1].mean()
    # Verlet's sum of n steps is g h^2 n (n + 1) / 2
    assert fallen == pytest.approx(0.5 * 9.81 * 0.2 * (0.2 + 1 / 120), abs=2e-3)


@quick
@given(seeds, st.sets(st.integers(0, N_POINTS - 1), max_size=8))
def test_points_of_infinite_mass_stay(seed: int, fixed: set[int]) -> None:
    mass = BODY.mass_kg.copy()
    stay = sorted(fixed | {HEAD})
    mass[stay] = np.inf
    state = MassSpringState(at_rest().points_m, impulse(seed))
    for after in (simulate(BODY, state, 0.1, mass), project_onto_constraints(BODY, state, mass)):
        assert (after.points_m[stay] == state.points_m[stay]).all()
        assert np.isfinite(after.points_m).all()


def test_heavy_points_move_least() -> None:
    start = at_rest()
    pulled = with_points(start, [ELBOW[0]], start.points_m[[ELBOW[0]]] + [0.1, 0.1, 0.1])
    moved = []
    for spread_m in (0.3, 0.01):
        spread = np.full(N_POINTS, np.inf)
        spread[ELBOW[0]] = spread_m
        after = project_onto_constraints(BODY, pulled, confident_masses(BODY.mass_kg, spread))
        moved.append(np.linalg.norm(after.points_m[ELBOW[0]] - pulled.points_m[ELBOW[0]]))
    assert moved[1] < 0.5 * moved[0]


def test_masses_follow_confidence() -> None:
    base = BODY.mass_kg
    spread = np.full(N_POINTS, np.inf)
    assert (confident_masses(base, spread) == base).all()
    spread[2:] = np.linspace(0.0, 0.5, 14)
    variable = confident_masses(base, spread, 20.0, -10.0)[2:] - base[2:]
    assert variable == pytest.approx(20.0 * np.exp(-10.0 * spread[2:]))


@quick
@given(seeds)
def test_the_floor_holds(seed: int) -> None:
    low = MIDDLE_M - [0.0, 0.5, 0.0]
    state = resting(at_rest().points_m + [0.0, 0.3, 0.0])
    state = MassSpringState(state.points_m, impulse(seed))
    for k in range(45):
        towards = head_middle(BODY, state) + np.clip(low - head_middle(BODY, state), -0.03, 0.03)
        state = with_head(BODY, state, towards)
        state = simulate(BODY, state, 1.0 / 30.0, floor_m=0.0)
        assert (state.points_m[:, 1] > BODY.constraints.clearance - 1e-9).all(), k
        assert strain_m(BODY, state.points_m)[BONES].max() < 0.02
    # knees give way forwards
    bent = [state.points_m[KNEE[s], 1] - state.points_m[ANKLE[s], 1] for s in (0, 1)]
    assert min(bent) < 0.4


def test_no_floor_is_there_where_none_is_known() -> None:
    state = resting(at_rest().points_m - [0.0, 3.0, 0.0])
    after = simulate(BODY, state, 0.1)
    assert np.abs(after.points_m - state.points_m).max() < 1e-3


def test_the_body_goes_with_its_head_by_four_fifths() -> None:
    start = at_rest()
    way = np.array([0.1, -0.05, 0.2])
    state = with_head(BODY, start, MIDDLE_M + way)
    assert np.linalg.norm(head_middle(BODY, state) - MIDDLE_M - way) < 1e-3
    others = np.arange(N_POINTS) != HEAD
    assert np.abs(state.points_m - start.points_m - 0.8 * way)[others].max() < 1e-3
    for _ in range(90):
        state = simulate(BODY, state, 1.0 / 30.0)
    assert np.abs(state.points_m - start.points_m - way).max() < 0.06


def test_time_that_does_not_pass_changes_nothing_and_long_gaps_are_cut() -> None:
    state = MassSpringState(at_rest().points_m, impulse(1))
    assert simulate(BODY, state, 0.0) is state
    most = SimulationParams().most_s
    assert (simulate(BODY, state, 60.0).points_m == simulate(BODY, state, most).points_m).all()


def test_legs_pass_each_other_but_not_through() -> None:
    start = at_rest()
    both = [ANKLE[0], ANKLE[1]]
    mass = BODY.mass_kg.copy()
    mass[both] = 40.0
    for ahead_m, passes in ((0.0, False), (0.5, True)):
        feet = start.points_m[both] + [[-0.15, 0.05, 0.5 * ahead_m], [0.15, 0.05, -0.5 * ahead_m]]
        state = project_onto_constraints(BODY, with_points(start, both, feet), mass)
        crossed = state.points_m[ANKLE[0], 0] < state.points_m[ANKLE[1], 0]
        assert crossed == passes
        assert legs_too_near_m(BODY, state.points_m) < 0.003


@pytest.mark.parametrize("stature_m", [1.2, 1.55, 2.0])
def test_a_body_is_sized_by_its_shape(stature_m: float) -> None:
    shape = BodyShape(stature_m, np.concatenate([np.ones(7), 1.0 + LOWER_FACTOR_SD]))
    body = build_body(shape)
    shin = np.linalg.norm(body.rest_m[KNEE[0]] - body.rest_m[ANKLE[0]])
    mean = np.linalg.norm(BODY.rest_m[KNEE[0]] - BODY.rest_m[ANKLE[0]])
    assert shin / mean == pytest.approx(stature_m / 1.75 * 1.04, rel=1e-6)
    start = relaxed_state(body, MIDDLE_M)
    state = MassSpringState(start.points_m, impulse(3))
    for _ in range(30):
        state = simulate(body, state, 1.0 / 30.0)
        assert_valid(body, state.points_m)
