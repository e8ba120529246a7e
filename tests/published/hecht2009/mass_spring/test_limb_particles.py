"""The particles of a limb are forced back to states that are valid beside the rest of the body."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.shape import mean_shape
from mocapd.published.hecht2009.mass_spring.body_points import LIMBS, N_POINTS
from mocapd.published.hecht2009.mass_spring.mass_spring_body import build_body
from mocapd.published.hecht2009.mass_spring.simulation import (
    SimulationParams,
    project_limb,
    project_onto_constraints,
    relaxed_state,
    resting,
)
from mocapd.published.hecht2009.mass_spring.springs import COMPLIANCE, spring_lengths
from mocapd.types import Floats
from tests.published.hecht2009.mass_spring.naive_constraints import (
    MIRROR,
    deepest_in_trunk_m,
    legs_too_near_m,
    worst_angle_rad,
)

BODY = build_body(mean_shape(1.75))
OF_SIDES = np.array([-1.0, 1.0, 1.0])
limbs = st.sampled_from(sorted(LIMBS))
seeds = st.integers(0, 2**32 - 1)
quick = settings(max_examples=25, deadline=None)


@cache  # not at import, where each of several processes would compile what it takes
def points_m() -> Floats:
    """Of the body at rest; nobody may change them."""
    return relaxed_state(BODY, np.array([0.0, 1.63, 0.0])).points_m


def cloud(limb: str, seed: int, spread_m: float, n: int = 20) -> Floats:
    noise = spread_m * np.random.default_rng(seed).normal(size=(n, 3, 3))
    out: Floats = points_m()[list(LIMBS[limb])] + noise
    return out


def with_limb(limb: str, particle: Floats) -> Floats:
    points = points_m().copy()
    points[list(LIMBS[limb])] = particle
    return points


@quick
@given(limbs, seeds, st.floats(0.01, 0.3))
def test_all_particles_at_once_are_each_one_alone_with_the_whole_body_held(
    limb: str, seed: int, spread_m: float
) -> None:
    particles = cloud(limb, seed, spread_m, 5)
    together = project_limb(BODY, limb, particles, points_m(), sweeps=8)
    mass = np.full(N_POINTS, np.inf)
    which = list(LIMBS[limb])
    mass[which] = BODY.mass_kg[which]
    for before, after in zip(particles, together, strict=True):
        one = project_limb(BODY, limb, before[None], points_m(), sweeps=8)[0]
        assert (one == after).all()
        # all constraints of the body, but nothing else may move
        whole = project_onto_constraints(
            BODY, resting(with_limb(limb, before)), mass,
            params=SimulationParams(projection_sweeps=8),
        ).points_m  # fmt: skip
        others = np.setdiff1d(np.arange(N_POINTS), which)
        assert (whole[others] == points_m()[others]).all()
        # the same constraints; the limits come twice as often for particles
        many = SimulationParams(projection_sweeps=400)
        far = project_onto_constraints(
            BODY, resting(with_limb(limb, before)), mass, params=many
        ).points_m
        settled = project_limb(BODY, limb, before[None], points_m(), sweeps=400)[0]
        if np.abs(far[which] - before).max() < 0.05:
            assert np.abs(far[which] - settled).max() < 0.02


@quick
@given(limbs, seeds, st.floats(0.01, 0.3))
def test_particles_become_valid(limb: str, seed: int, spread_m: float) -> None:
    after = project_limb(BODY, limb, cloud(limb, seed, spread_m), points_m(), sweeps=60)
    for particle in after:
        points = with_limb(limb, particle)
        assert np.isfinite(points).all()
        assert np.degrees(worst_angle_rad(BODY, points)) < 6.0
        assert deepest_in_trunk_m(BODY, points) < 0.005
        assert legs_too_near_m(BODY, points) < 0.005
        strain = np.abs(spring_lengths(points) - BODY.constraints.lengths)
        assert strain[COMPLIANCE == 0.0].max() < 0.01


@pytest.mark.parametrize("limb", sorted(LIMBS))
def test_a_few_sweeps_take_most_of_the_way(limb: str) -> None:
    particles = cloud(limb, 5, 0.1, 200)
    bones = COMPLIANCE == 0.0

    def wrong(p: Floats) -> float:
        whole = np.stack([with_limb(limb, one) for one in p])
        return float(np.abs(spring_lengths(whole) - BODY.constraints.lengths)[:, bones].mean())

    before = wrong(particles)
    two, four = (wrong(project_limb(BODY, limb, particles, points_m(), sweeps=n)) for n in (2, 4))
    assert two < 0.4 * before
    assert four < 0.2 * before


@quick
@given(limbs, seeds)
def test_valid_particles_stay(limb: str, seed: int) -> None:
    valid = project_limb(BODY, limb, cloud(limb, seed, 0.05, 4), points_m(), sweeps=400)
    again = project_limb(BODY, limb, valid, points_m(), sweeps=4)
    # what springs of the trunk give is taken back a little
    assert np.abs(again - valid).max() < 0.02


@quick
@given(seeds)
def test_left_particles_are_right_ones_mirrored(seed: int) -> None:
    mirrored_points = (points_m() * OF_SIDES)[MIRROR]
    for kind in ("arm", "leg"):
        particles = cloud(f"left_{kind}", seed, 0.1, 4)
        left = project_limb(BODY, f"left_{kind}", particles, points_m(), sweeps=40)
        right = project_limb(
            BODY, f"right_{kind}", particles * OF_SIDES, mirrored_points, sweeps=40
        )
        assert np.abs(left - right * OF_SIDES).max() < 0.01


@quick
@given(limbs, seeds)
def test_particles_stay_above_a_floor(limb: str, seed: int) -> None:
    after = project_limb(BODY, limb, cloud(limb, seed, 0.3), points_m(), floor_m=0.0, sweeps=8)
    assert (after[:, :, 1] > BODY.constraints.clearance[list(LIMBS[limb])] - 1e-9).all()


@pytest.mark.parametrize("limb", sorted(LIMBS))
def test_particles_whose_points_are_one_find_apart(limb: str) -> None:
    particles = np.stack(
        [np.tile(points_m()[LIMBS[limb][0]], (3, 1)), np.tile(points_m()[1], (3, 1))]
    )
    assert np.isfinite(project_limb(BODY, limb, particles, points_m(), sweeps=2)).all()


def test_particles_themselves_are_not_touched() -> None:
    particles = cloud("left_arm", 1, 0.1)
    kept = particles.copy()
    project_limb(BODY, "left_arm", particles, points_m())
    assert (particles == kept).all()
