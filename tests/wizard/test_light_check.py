"""Flicker against the mains in the brightness of rows, and what is said of dark and white pictures."""

import numpy as np
import pytest

from mocapd.calibrate.light.light_check import Flicker, find_flicker, light_problems
from mocapd.types import Bytes, Floats, Ints


def film(
    rate_hz: float,
    pulses_hz: float = 0.0,
    depth: float = 0.1,
    readout_s: float = 0.02,
    moving: bool = False,
    drift: float = 0.0,
    seed: int = 0,
) -> tuple[Ints, Floats]:
    """Two and a half seconds of row brightnesses (n,96): pulsing lamps, a person who walks and waves, a
    light that slowly grows, stamps that jitter by a millisecond."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(round(2.5 * rate_hz)) / rate_hz
    rows = np.linspace(0, 1, 96)
    level = np.repeat((120 + 50 * np.sin(5 * rows))[None], len(t_s), axis=0)
    if moving:
        at = 0.5 + 0.3 * np.sin(2 * np.pi * 0.7 * t_s + seed) + 0.1 * np.sin(14 * t_s)
        level = level - 40 * np.exp(-(((rows[None] - at[:, None]) / 0.15) ** 2))
    level = level * (1 + drift * t_s[:, None])
    if pulses_hz:
        when_s = t_s[:, None] + readout_s * rows[None]
        level = level * (1 + depth * np.cos(2 * np.pi * pulses_hz * when_s + 1.0))
    level = level + rng.normal(0, 0.3, level.shape)
    stamps = np.round(1e9 * (t_s + rng.uniform(0, 1e-3, len(t_s)))).astype(np.int64)
    return stamps, level


@pytest.mark.parametrize(
    ("rate_hz", "pulses_hz", "moving"),
    [
        (30, 100, False),
        (25, 120, False),
        (15, 100, False),
        (60, 100, False),
        # bands that creep, as the rate is nearly a divisor; not told from a person who walks about
        (29.97, 120, False),
        (25.03, 100, False),
        (59.94, 120, False),
        (30, 100, True),
        (25, 120, True),
        (15, 100, True),
        (60, 100, True),
    ],
)
def test_flicker_is_seen_and_its_mains_named(
    rate_hz: float, pulses_hz: float, moving: bool
) -> None:
    found = find_flicker(*film(rate_hz, pulses_hz, depth=0.1, moving=moving))
    assert found is not None
    assert found.mains_hz == pulses_hz / 2


@pytest.mark.parametrize("rate_hz", [15.0, 25.0, 29.97, 30.0, 60.0])
@pytest.mark.parametrize("seed", range(6))
def test_a_person_who_moves_and_growing_light_are_no_flicker(rate_hz: float, seed: int) -> None:
    assert find_flicker(*film(rate_hz, moving=True, drift=0.1, seed=seed)) is None
    assert find_flicker(*film(rate_hz, drift=0.3, seed=seed)) is None


def test_a_global_shutter_flickers_as_a_whole() -> None:
    found = find_flicker(*film(30, 100, depth=0.05, readout_s=0.0))
    assert found is not None
    assert found.mains_hz == 50


def test_too_few_frames_say_nothing() -> None:
    stamps, rows = film(30, 100)
    assert find_flicker(stamps[:20], rows[:20]) is None
    assert find_flicker(stamps[:0], rows[:0]) is None
    assert find_flicker(*film(6, 100)) is None


def test_flicker_too_weak_to_harm_is_not_told() -> None:
    assert find_flicker(*film(30, 100, depth=0.004)) is None


def grey(level: int) -> Bytes:
    return np.full((480, 640, 3), level, np.uint8)


def test_dark_white_and_good_pictures() -> None:
    assert not [*light_problems("cam0", grey(120), None, 0.008)]
    (dark,) = light_problems("cam0", grey(20), None, 0.033)
    assert "too dark" in dark.what
    (dim,) = light_problems("cam0", grey(110), None, 0.033)
    assert "33 ms" in dim.what
    window = grey(120)
    window[:, :200] = 255
    (white,) = light_problems("cam0", window, None, 0.008)
    assert white.what.startswith("31 %")
    assert white.where == "cam0"


@pytest.mark.parametrize(
    ("exposure_s", "word"), [(0.002, "dim the lamps"), (0.012, "multiple of 1/120"), (None, "own")]
)
def test_the_mend_of_flicker_fits_the_camera(exposure_s: float | None, word: str) -> None:
    (problem,) = light_problems("cam0", grey(120), Flicker(60, 0.05), exposure_s)
    assert "60 Hz" in problem.what
    assert word in problem.fix
