"""What each preset costs and brings, measured; `pytest -s` prints the table of smoothing.py."""

import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from mocapd.geometry import rotations
from mocapd.pipeline import smoothing
from mocapd.pipeline.one_euro import RotationOneEuro, VectorOneEuro
from mocapd.pipeline.smoothing import PRESETS
from mocapd.types import Floats

DT_S = 1.0 / 30.0
T_S = np.arange(0.0, 24.0, DT_S)


@dataclass(frozen=True)
class Row:
    """Jitter left [1], lag [s]: of the root, of a bone."""

    root_jitter: float
    root_lag_s: float
    bone_jitter: float
    bone_lag_s: float


def _lag_s(hz: float, filtered: Floats) -> float:
    """The phase lag of the fundamental, as a time."""
    settled = T_S >= 4.0
    phase = np.angle(np.sum(filtered[settled] * np.exp(-2j * np.pi * hz * T_S[settled])))
    reference = np.sin(2 * np.pi * hz * T_S[settled])
    phase -= np.angle(np.sum(reference * np.exp(-2j * np.pi * hz * T_S[settled])))
    return float(-phase / (2 * np.pi * hz))


def _filter_positions(preset: str, xyz_m: Floats) -> Floats:
    chosen = PRESETS[preset]
    if chosen is None:
        return xyz_m
    one_euro = VectorOneEuro(chosen.root)
    return np.array([one_euro.step(x, DT_S) for x in xyz_m])


def _filter_rotvecs(preset: str, rotvec_rad: Floats) -> Floats:
    chosen = PRESETS[preset]
    if chosen is None:
        return rotvec_rad
    one_euro = RotationOneEuro(chosen.bones)
    return rotations.log(np.array([one_euro.step(q, DT_S) for q in rotations.exp(rotvec_rad)]))


def measure(preset: str) -> Row:
    rng = np.random.default_rng(3)
    noise = rng.standard_normal((len(T_S), 3))
    along_x = np.array([1.0, 0.0, 0.0])
    sway_m = 0.3 * np.sin(2 * np.pi * 0.5 * T_S)[:, None] * along_x
    swing_rad = np.radians(60.0) * np.sin(2 * np.pi * 1.0 * T_S)[:, None] * along_x
    still_m = 0.005 * noise
    still_rad = np.radians(2.0) * noise
    return Row(
        float(_filter_positions(preset, still_m)[60:].std() / still_m[60:].std()),
        _lag_s(0.5, _filter_positions(preset, sway_m + still_m)[:, 0]),
        float(_filter_rotvecs(preset, still_rad)[60:].std() / still_rad[60:].std()),
        _lag_s(1.0, _filter_rotvecs(preset, swing_rad + still_rad)[:, 0]),
    )


@pytest.fixture(scope="module")
def table() -> dict[str, Row]:
    rows = {preset: measure(preset) for preset in PRESETS}
    for name, r in rows.items():
        print(
            f"\n| {name:10} | {r.root_jitter:16.0%} | {1e3 * r.root_lag_s:2.0f} ms | "
            f"{r.bone_jitter:16.0%} | {1e3 * r.bone_lag_s:2.0f} ms |",
            end="",
        )
    return rows


def test_off_changes_nothing(table: dict[str, Row]) -> None:
    off = table["off"]
    assert (off.root_jitter, off.bone_jitter) == (1.0, 1.0)
    assert abs(off.root_lag_s) < 1e-3


def test_presets_are_ordered_and_none_lags_a_frame(table: dict[str, Row]) -> None:
    rows = [table[name] for name in ("off", "responsive", "balanced", "smooth")]
    for less, more in pairwise(rows):
        assert more.root_jitter < less.root_jitter
        assert more.bone_jitter < less.bone_jitter
        assert more.root_lag_s > less.root_lag_s
        assert more.bone_lag_s > less.bone_lag_s
    assert max(rows[-1].root_lag_s, rows[-1].bone_lag_s) < DT_S


@pytest.mark.parametrize("preset", list(PRESETS))
def test_the_documented_figures_are_those_measured(table: dict[str, Row], preset: str) -> None:
    source = Path(smoothing.__file__).read_text()
    line = next(text for text in source.splitlines() if text.startswith(f"# | {preset} "))
    documented = [int(figure) for figure in re.findall(r"(\d+) (?:%|ms)", line)]
    row = table[preset]
    measured = [100 * row.root_jitter, 1e3 * row.root_lag_s]
    measured += [100 * row.bone_jitter, 1e3 * row.bone_lag_s]
    assert documented == pytest.approx(measured, abs=1.0)
