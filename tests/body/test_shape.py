"""Body shapes: each factor scales its own part of the skeleton and nothing else."""

import numpy as np
import pytest

from mocapd.body.shape import FACTORS, N_FACTORS, BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, standard_skeleton
from mocapd.errors import ConfigError

STATURE_M = 1.80


def shape(**factors: float) -> BodyShape:
    return BodyShape(STATURE_M, np.array([factors.get(name, 1.0) for name in FACTORS]))


def length_m(of: BodyShape, a: str, b: str) -> float:
    rest = skeleton_of(of).rest_m
    return float(np.linalg.norm(rest[INDEX[a]] - rest[INDEX[b]]))


def test_the_mean_shape_is_the_standard_skeleton() -> None:
    np.testing.assert_allclose(
        skeleton_of(mean_shape(STATURE_M)).rest_m, standard_skeleton(STATURE_M).rest_m, atol=1e-12
    )


@pytest.mark.parametrize(
    ("factor", "a", "b"),
    [
        ("shoulder_width", "leftUpperArm", "rightUpperArm"),
        ("shoulder_width", "leftShoulder", "rightShoulder"),
        ("upper_arm_length", "leftUpperArm", "leftLowerArm"),
        ("upper_arm_length", "rightUpperArm", "rightLowerArm"),
        ("forearm_length", "leftLowerArm", "leftHand"),
        ("forearm_length", "rightLowerArm", "rightHand"),
    ],
)
def test_a_factor_scales_its_own_length(factor: str, a: str, b: str) -> None:
    mean = length_m(mean_shape(STATURE_M), a, b)
    for name in FACTORS:
        scale = 1.1 if name == factor else 1.0
        assert length_m(shape(**{name: 1.1}), a, b) == pytest.approx(scale * mean)


def test_a_longer_torso_raises_what_is_above_the_hips_only() -> None:
    mean = skeleton_of(mean_shape(STATURE_M)).rest_m
    tall = skeleton_of(shape(torso_length=1.1)).rest_m
    for name, j in INDEX.items():
        legs = name == "hips" or any(part in name for part in ("Leg", "Foot", "Toes"))
        above = mean[j, 1] - mean[0, 1]
        assert tall[j, 1] - mean[j, 1] == pytest.approx(0.0 if legs else 0.1 * above)


def test_girths_leave_the_skeleton_alone() -> None:
    wide = shape(torso_width=1.2, torso_depth=0.9, arm_girth=1.3)
    np.testing.assert_array_equal(
        skeleton_of(wide).rest_m, skeleton_of(mean_shape(STATURE_M)).rest_m
    )


@pytest.mark.parametrize("stature_m", [0.0, 0.7, 2.6, 175.0, float("nan")])
def test_an_impossible_stature_is_told(stature_m: float) -> None:
    with pytest.raises(ConfigError, match="stature"):
        mean_shape(stature_m)


@pytest.mark.parametrize(
    "factors", [np.ones(N_FACTORS - 1), np.full(N_FACTORS, 0.2), np.full(N_FACTORS, np.nan)]
)
def test_impossible_factors_are_told(factors: np.ndarray) -> None:
    with pytest.raises(ConfigError, match="factors"):
        BodyShape(STATURE_M, factors)
