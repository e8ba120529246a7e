"""The annealed particle filter: what is selected, what shrinks, and that a peak is found."""

from dataclasses import replace

import numpy as np
import pytest

from lab.rao_hodges.clip_angles import LimbAngles, angle_errors, other_angles
from lab.rao_hodges.experiment import LimbVariant, chains, principal_space, track_limb
from mocapd.geometry import rotations
from mocapd.published.rao_hodges.annealing import (
    AnnealingParams,
    SearchSpace,
    Selection,
    Weigh,
    anneal,
)
from mocapd.published.rao_hodges.limb_motion import STEP_DEG, search_space
from mocapd.types import Floats

FREE = np.full(4, np.inf)
SPACE = SearchSpace(np.full(4, 0.1), -FREE, FREE)
PEAK = np.array([0.15, -0.1, 0.05, 0.0])


def near_peak(angles: Floats) -> Floats:
    weights: Floats = np.exp(-(((angles - PEAK) / 0.3) ** 2).sum(axis=1))
    return weights


def searched(params: AnnealingParams, seed: int = 0, weigh: Weigh = near_peak) -> Floats:
    return anneal(np.zeros(4), SPACE, weigh, np.random.default_rng(seed), params).angles


def test_the_estimate_goes_to_the_peak_and_is_the_same_each_time() -> None:
    found = searched(AnnealingParams())
    assert np.linalg.norm(found - PEAK) < 0.5 * np.linalg.norm(PEAK)
    assert np.array_equal(found, searched(AnnealingParams()))


def test_the_heavier_half_goes_on_whatever_the_scale_of_the_weights() -> None:
    """So that smoothing by an exponent decides nothing above layer 0: only the order counts."""
    seen: list[list[Floats]] = [[], []]
    for smoothing, layers in zip((1.0, 0.1), seen, strict=True):

        def weigh(angles: Floats, layers: list[Floats] = layers) -> Floats:
            layers.append(angles)
            return near_peak(angles)

        searched(AnnealingParams(smoothing=smoothing), weigh=weigh)
    assert [len(layer) for layer in seen[0]] == [81, 81, 81]
    for one, other in zip(*seen, strict=True):
        assert np.array_equal(one, other)


def test_noise_shrinks_and_children_stand_around_the_heavier_half() -> None:
    layers: list[Floats] = []

    def weigh(angles: Floats) -> Floats:
        layers.append(angles)
        return np.exp(angles[:, 0])  # always more of the first angle

    searched(AnnealingParams(particles=2000), weigh=weigh)
    spread = [layer[:, 1].std() for layer in layers]
    assert spread[0] == pytest.approx(0.1, rel=0.1)
    assert spread[1] == pytest.approx(np.sqrt(0.01 + 0.005), rel=0.1)
    assert spread[2] == pytest.approx(np.sqrt(0.01 + 0.005 + 0.0025), rel=0.1)
    # the mean of the upper half of a normal distribution
    assert layers[1][:, 0].mean() == pytest.approx(0.0798, rel=0.1)


def test_random_selection_searches_worse() -> None:
    away = {
        selection: np.mean(
            [
                np.linalg.norm(searched(AnnealingParams(selection=selection), seed) - PEAK)
                for seed in range(20)
            ]
        )
        for selection in Selection
    }
    assert away[Selection.HEAVIEST] < away[Selection.RANDOM]


def test_no_weight_at_all_leaves_a_finite_estimate_about_the_start() -> None:
    for selection in Selection:
        found = searched(AnnealingParams(selection=selection), weigh=lambda a: np.zeros(len(a)))
        assert np.abs(found).max() < 0.2


def test_limits_hold() -> None:
    space = replace(SPACE, upper=np.full(4, 0.02))
    found = anneal(np.zeros(4), space, near_peak, np.random.default_rng(0), AnnealingParams())
    assert (found.angles <= 0.02).all()


def test_noise_is_a_third_of_the_largest_step_for_the_time_between_frames() -> None:
    legs = chains()["legs"]
    slow, fast = search_space(legs, 1.0 / 30.0), search_space(legs, 1.0 / 60.0)
    assert fast.sd[legs.kinds.index("knee_x")] == pytest.approx(
        np.radians(STEP_DEG["knee_x"] / 3.0)
    )
    assert slow.sd == pytest.approx(2.0 * fast.sd)


def swung(frames: int) -> LimbAngles:
    """Legs that walk on the spot, a step a second."""
    swing = np.sin(2.0 * np.pi * np.arange(frames) / 60.0)[:, None]
    step = np.radians([0, 0, 25.0, -20.0, 0, 0, 0, -25.0, 20.0, 0])
    base = np.radians([3.0, 0, -5.0, 30.0, 0, -3.0, 0, -5.0, 30.0, 0])
    return LimbAngles("swung", "legs", 1.0 / 60.0, base + swing * step)


@pytest.mark.parametrize(
    "variant",
    [
        LimbVariant("published"),
        LimbVariant("converse", converse=1.0),
        LimbVariant("2D", silhouettes=True),
    ],
    ids=lambda variant: variant.label,
)
def test_walking_legs_are_followed(variant: LimbVariant) -> None:
    frames = 12 if variant.silhouettes else 60
    outcome = track_limb(swung(frames), variant, seed=0)
    assert outcome.errors_deg.mean() < 8.0
    assert outcome.exchanged == 0
    assert outcome.errors_deg.shape == (frames - 1, 10)


def test_principal_components_span_what_was_learned() -> None:
    truth = swung(60)
    space = principal_space(search_space(chains()["legs"], truth.dt_s), [truth], 1)
    # the knee's lower limit is not reached, so one component holds all of the swing
    assert space.angles(space.vector(truth.angles[7])) == pytest.approx(truth.angles[7], abs=1e-9)


def test_both_triples_of_one_rotation_count_as_right() -> None:
    ball = np.radians([30.0, 80.0, -20.0])
    true, found = (np.concatenate([one, [0.3]]) for one in (ball, other_angles(ball)))
    assert angle_errors("left_arm", found, true) == pytest.approx(np.zeros(4), abs=1e-9)

    def turned(xyz: Floats) -> Floats:
        x, y, z = (rotations.exp(angle * axis) for angle, axis in zip(xyz, np.eye(3), strict=True))
        return rotations.multiply(rotations.multiply(x, y), z)

    assert rotations.angle_rad(turned(ball), turned(other_angles(ball))) == pytest.approx(
        0.0, abs=1e-7
    )
