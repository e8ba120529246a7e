"""Checks the light: too dark, over-exposed, or flickering with the mains.

Lamps on the mains pulse at twice its frequency. A rolling shutter exposes row after row, so the
pulses show as bands; from frame to frame they move by the alias of the pulses at the frame rate
(100 Hz at 30 frames: a third of a period). Exposures of whole pulses do not show them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mocapd.errors import Problem
from mocapd.types import Bytes, Floats, Ints

_DARK_LEVEL = 45.0  # of 255, 75th percentile of luma
_WHITE = 250
_WHITE_SHARE = 0.2
_SLOW_HZ = 1.5  # aliases slower than this look like movement: only travelling bands count
_LEAST_DEPTH = 0.007  # rms of the brightness, relative: less is harmless
_PEAK = 8.0  # power over that of the neighbouring frequencies
_ALIKE = 0.6  # least share of all rows' power in one wave along the rows
_EXPLAINED = 0.6  # least share of all change in travelling bands
_LEAST_S = 1.2
_LEAST_HZ = 10.0  # under this rate, aliases of lamps and of people are the same
_MAINS_HZ = (50, 60)


@dataclass(frozen=True, slots=True)
class Flicker:
    """mains_hz: 50 or 60; depth: rms change of brightness, relative."""

    mains_hz: int
    depth: float


def light_problems(
    camera: str, pixels: Bytes, flicker: Flicker | None, exposure_s: float | None
) -> Iterator[Problem]:
    """Problems of the light in this picture (h,w,3) BGR.

    flicker: the result of `find_flicker` for the frames; exposure_s: exposure time [s], None where unknown.
    """
    thin = pixels[::12, ::12].reshape(-1, 3)
    if float(np.percentile(thin @ np.array([0.114, 0.587, 0.299]), 75)) < _DARK_LEVEL:
        yield Problem("the picture is too dark", camera, "switch on more light, or open the blinds")
    elif exposure_s is not None and exposure_s > 0.02:
        yield Problem(
            f"dim light: each picture takes {1e3 * exposure_s:.0f} ms, so quick movements blur",
            camera,
            "more light makes it better; it works as it is",
        )
    white = float((thin.min(axis=1) >= _WHITE).mean())
    if white > _WHITE_SHARE:
        yield Problem(
            f"{100 * white:.0f} % of the picture is plain white",
            camera,
            "turn it away from the window or lamp, draw the curtain, then lock again",
        )
    if flicker is not None:
        yield _flicker_problem(camera, flicker, exposure_s)


def _flicker_problem(camera: str, flicker: Flicker, exposure_s: float | None) -> Problem:
    pulses_hz = 2 * flicker.mains_hz
    if exposure_s is None:
        fix = "set the camera's own flicker filter to the mains, or use daylight or other lamps"
    elif exposure_s < 0.9 / pulses_hz:
        fix = (
            f"it is so bright that the exposure is under 1/{pulses_hz} s: dim the lamps or shade the "
            "window, then lock again; or use lamps that do not flicker"
        )
    else:
        fix = (
            f"lock again, which sets the exposure to a multiple of 1/{pulses_hz} s, or use daylight "
            "or other lamps"
        )
    return Problem(
        f"lamps flicker with the mains ({flicker.mains_hz} Hz): bands run over the picture",
        camera,
        fix,
    )


def find_flicker(t_ns: Ints, rows: Floats) -> Flicker | None:
    """The flicker of lamps in successive frames of a camera, None without.

    t_ns (n,): their times; rows (n,r): the brightness of rows, 0..255. At least 1.2 s of frames.
    """
    if len(t_ns) < 12 or (t_ns[-1] - t_ns[0]) / 1e9 < _LEAST_S:
        return None
    t_s, rate_hz = _even_times(t_ns)
    if rate_hz < _LEAST_HZ:
        return None
    change = np.log(rows + 4.0)
    change = change - change.mean(axis=0)
    change -= np.outer(t_s - t_s.mean(), (t_s - t_s.mean()) @ change / np.var(t_s) / len(t_s))
    flickers = []
    for mains_hz in _MAINS_HZ:
        pulses_hz = 2.0 * mains_hz
        if _alias_hz(pulses_hz, rate_hz) < _SLOW_HZ:
            depth = _travelling(t_s, change, pulses_hz)
        else:
            depth = _peak(t_s, change, pulses_hz, rate_hz)
        if depth >= _LEAST_DEPTH:
            flickers.append(Flicker(mains_hz, depth))
    return max(flickers, key=lambda flicker: flicker.depth, default=None)


def _even_times(t_ns: Ints) -> tuple[Floats, float]:
    """The frames' times [s] without the jitter of the stamps, and their rate [Hz]."""
    t_s = (t_ns - t_ns[0]) / 1e9
    period_s = float(np.median(np.diff(t_s)))
    index = np.round(t_s / period_s)
    slope, begin = np.polyfit(index, t_s, 1)
    return begin + slope * index, float(1.0 / slope)


def _alias_hz(frequency_hz: Any, rate_hz: float) -> Any:
    """The alias of a frequency at this rate of frames, 0 to half of it."""
    return np.abs(frequency_hz - rate_hz * np.round(frequency_hz / rate_hz))


def _peak(t_s: Floats, change: Floats, pulses_hz: float, rate_hz: float) -> float:
    """Relative rms of pulses at this frequency, row after row; 0.0 when it does not exceed the neighbouring
    frequencies, or differs between rows, as people do and lamps do not."""
    window = np.hanning(len(t_s) + 2)[1:-1]
    window *= 2.0 / window.sum()
    rows = change.shape[1]
    along = np.exp(-2j * np.pi * np.outer(np.arange(rows) / rows, np.arange(0.0, 5.01, 0.25)))

    def powers(frequencies_hz: Floats) -> tuple[Floats, Floats]:
        """Of the best wave along the rows, and of each row by itself."""
        waves = (np.exp(-2j * np.pi * np.outer(frequencies_hz, t_s)) * window) @ change
        return (np.abs(waves @ along / rows) ** 2).max(axis=1), (np.abs(waves) ** 2).mean(axis=1)

    apart_hz = np.arange(1.8, 4.3, 0.25)
    away_hz = pulses_hz + np.concatenate([apart_hz, -apart_hz])
    alias_hz = _alias_hz(away_hz, rate_hz)
    own_hz = _alias_hz(pulses_hz, rate_hz)
    away_hz = away_hz[(alias_hz > 1.0) & (np.abs(alias_hz - own_hz) > 1.5)]
    together, alone = powers(pulses_hz + np.arange(-0.6, 0.61, 0.1))
    top = int(together.argmax())
    floor = float(np.median(powers(away_hz)[0]))
    alike = together[top] > _ALIKE * alone[top]
    return float(np.sqrt(together[top] / 2.0)) if alike and together[top] > _PEAK * floor else 0.0


def _travelling(t_s: Floats, change: Floats, pulses_hz: float) -> float:
    """Relative rms of bands that travel over the rows; 0.0 when most of the change is something else.

    The phase of the pulses grows along the rows by 2 pi pulses_hz readout_s, 1 to 5 bands a picture.
    """
    total = float((change**2).sum())
    rows = change.shape[1]
    best = 0.0
    along = np.exp(-2j * np.pi * np.outer(np.arange(1.0, 5.01, 0.2), np.arange(rows) / rows))
    for frequency_hz in pulses_hz + np.arange(-0.4, 0.41, 0.1):
        wave = np.exp(-2j * np.pi * frequency_hz * t_s)
        wave -= wave.mean()
        wave -= (t_s - t_s.mean()) * ((t_s - t_s.mean()) @ wave) / np.var(t_s) / len(t_s)
        inner = along @ (wave @ change)  # (k,)
        square = float((np.abs(wave) ** 2).sum()) * rows
        twice = (wave**2).sum() * (along**2).sum(axis=1)
        # least squares of change = Re(A conj(g)): normal equations of real and imaginary part
        cc, ss, cs = (square + twice.real) / 2, (square - twice.real) / 2, twice.imag / 2
        determinant = cc * ss - cs**2
        fitted = (
            ss * inner.real**2 - 2 * cs * inner.real * inner.imag + cc * inner.imag**2
        ) / np.maximum(determinant, 1e-9 * square**2)
        best = max(best, float(fitted.max()))
    return float(np.sqrt(best / change.size)) if best > _EXPLAINED * total else 0.0
