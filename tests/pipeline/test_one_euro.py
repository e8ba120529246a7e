"""The One-Euro filter against the paper's own formulation, and what must hold on rotations."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.pipeline.one_euro import OneEuroParams, RotationOneEuro, VectorOneEuro, smoothing_factor

PARAMS = OneEuroParams(1.2, 0.7, 1.0)


def naive_scalar(samples: list[float], dts_s: list[float], p: OneEuroParams) -> list[float]:
    """Algorithm 1 of the paper, for one scalar."""

    def alpha(cutoff_hz: float, dt_s: float) -> float:
        tau_s = 1.0 / (2.0 * math.pi * cutoff_hz)
        return 1.0 / (1.0 + tau_s / dt_s)

    out, x, dx = [], samples[0], 0.0
    for k, (sample, dt_s) in enumerate(zip(samples, dts_s, strict=True)):
        if k:
            a = alpha(p.speed_cutoff_hz, dt_s)
            dx = a * (sample - x) / dt_s + (1 - a) * dx
            a = alpha(p.min_cutoff_hz + p.beta * abs(dx), dt_s)
            x = a * sample + (1 - a) * x
        out.append(x)
    return out


def test_along_a_line_it_is_the_papers_filter_at_any_rate() -> None:
    rng = np.random.default_rng(1)
    dts_s = rng.uniform(0.005, 0.1, 50).tolist()
    samples = np.cumsum(rng.standard_normal(50)).tolist()
    filtered = VectorOneEuro(PARAMS)
    got = [
        filtered.step(np.array([0.0, s, 0.0]), dt)[1] for s, dt in zip(samples, dts_s, strict=True)
    ]
    assert got == pytest.approx(naive_scalar(samples, dts_s, PARAMS), abs=1e-12)


def test_about_one_axis_rotations_are_the_papers_filter_on_the_angle() -> None:
    rng = np.random.default_rng(2)
    dts_s = rng.uniform(0.005, 0.1, 50).tolist()
    angles = np.cumsum(0.2 * rng.standard_normal(50)).tolist()
    axis = np.array([0.6, 0.0, 0.8])
    filtered = RotationOneEuro(PARAMS)
    quats = [
        filtered.step(rotations.exp(a * axis), dt) for a, dt in zip(angles, dts_s, strict=True)
    ]
    expected = rotations.exp(np.array(naive_scalar(angles, dts_s, PARAMS))[:, None] * axis)
    assert rotations.angle_rad(np.array(quats), expected).max() < 1e-7


def test_each_joint_of_a_batch_is_filtered_as_if_alone() -> None:
    rng = np.random.default_rng(3)
    track = rng.standard_normal((20, 4, 3)) * np.array([0.01, 0.1, 1.0, 3.0])[:, None]
    together = VectorOneEuro(PARAMS)
    batch = np.array([together.step(x, 0.03) for x in track])
    for j in range(4):
        alone = VectorOneEuro(PARAMS)
        assert np.allclose(batch[:, j], [alone.step(x[j], 0.03) for x in track])


def test_the_sign_of_a_quaternion_does_not_matter() -> None:
    rng = np.random.default_rng(4)
    quats = rotations.exp(rng.standard_normal((30, 5, 3)))
    a, b = RotationOneEuro(PARAMS), RotationOneEuro(PARAMS)
    for q in quats:
        flipped = q * rng.choice([-1.0, 1.0], size=(5, 1))
        out = a.step(q, 0.03)
        assert np.allclose(out, b.step(flipped, 0.03))
        assert np.allclose(np.linalg.norm(out, axis=-1), 1.0)
        assert (out[:, 3] >= 0.0).all()


def test_a_rotation_of_half_a_turn_and_beyond_takes_the_short_way() -> None:
    axis = np.array([0.0, 1.0, 0.0])
    filtered = RotationOneEuro(OneEuroParams(2.0, 1.0))
    angles = np.radians(np.arange(150.0, 215.0, 5.0))
    outs = np.array([filtered.step(rotations.exp(a * axis), 1 / 30) for a in angles])
    steps = rotations.angle_rad(outs[1:], outs[:-1])
    assert steps.max() < np.radians(6.0)


@given(st.floats(1e-3, 0.4), st.floats(0.1, 30.0))
def test_a_constant_stays_and_a_step_is_approached_without_overshoot(
    dt_s: float, cutoff_hz: float
) -> None:
    assert 0.0 < float(smoothing_factor(cutoff_hz, dt_s)) < 1.0
    filtered = VectorOneEuro(OneEuroParams(cutoff_hz, 0.5))
    still = np.array([1.0, -2.0, 0.5])
    for _ in range(3):
        assert np.array_equal(filtered.step(still, dt_s), still)
    distance = np.inf
    for _ in range(20):
        now = float(np.linalg.norm(filtered.step(still + 1.0, dt_s) - (still + 1.0)))
        assert now <= distance
        distance = now


def test_outputs_are_the_callers_own() -> None:
    filtered = VectorOneEuro(PARAMS)
    sample = np.ones(3)
    filtered.step(sample, 0.03)[:] = 99.0
    sample[:] = 77.0
    assert np.array_equal(filtered.step(np.ones(3), 0.03), np.ones(3))


@pytest.mark.parametrize("bad", [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, float("nan"))])
def test_params_that_make_no_sense_are_refused(bad: tuple[float, float, float]) -> None:
    with pytest.raises(ConfigError, match="smoothing"):
        OneEuroParams(*bad)
