"""Speed and acceleration from positions that shake: local polynomials (Savitzky and Golay 1964). Pure.

Around every frame a polynomial is fitted to the frames nearest in time, by least squares, and differentiated
there. Fitted at the frames' own times, so that lost frames and a jittering clock need no resampling.

Window and order are chosen by measurement on many clips: `mocapd-analysis accuracy` prints the table.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats, Ints
from mocapd_analysis.session import SHORTEST_SEGMENT, segments_of


@dataclass(frozen=True, slots=True)
class Smoothing:
    """window_s: how long a piece one polynomial is fitted to [s]; order: its degree; edge_order: where there are
    frames on one side only, which a high degree follows into their noise."""

    window_s: float
    order: int
    edge_order: int = 3


# An arm's swing has its speed up to some 10 Hz. Order 6 over 0.27 s (9 frames at 30 Hz, 17 at 60 Hz)
# passes 8 Hz nearly whole. Lower orders over the same time take up to 10 % off a throw, shorter
# windows leave the tracker's noise.
SPEED = Smoothing(0.27, 6)
# An acceleration's noise grows with the square of the frequency: a lower degree has the least error over all, at
# the price of its peaks, which come out some 30 % low.
ACCELERATION = Smoothing(0.27, 4)

_BLOCK = 2000  # frames at once: bounds the memory of an hour's session


def derivatives(
    times_s: Floats, values: Floats, smoothing: Smoothing, count: int = 2
) -> tuple[Floats, ...]:
    """The values (F,...) smoothed, and their first `count` derivatives by time.

    NaN where a run without gaps is too short to tell. `times_s` (F,) increase.
    """
    flat = np.asarray(values, dtype=float).reshape(len(times_s), -1)
    out = np.full((count + 1, *flat.shape), np.nan)
    for part in segments_of(times_s):
        if part.stop - part.start >= SHORTEST_SEGMENT:
            out[:, part] = _of_segment(times_s[part], flat[part], smoothing, count)
    return tuple(one.reshape(np.shape(values)) for one in out)


def _of_segment(times_s: Floats, values: Floats, smoothing: Smoothing, count: int) -> Floats:
    """(count+1, F, C) of one run of frames."""
    frames = len(times_s)
    step_s = float(np.median(np.diff(times_s)))
    half = max(round(0.5 * smoothing.window_s / step_s), (smoothing.order + 2) // 2)
    width = min(2 * half + 1, frames)
    half = (width - 1) // 2
    first = np.clip(np.arange(frames) - half, 0, frames - width)
    is_edge = first != np.arange(frames) - half
    out = np.empty((count + 1, *values.shape))
    for chosen, order in (
        (np.flatnonzero(~is_edge), smoothing.order),
        (np.flatnonzero(is_edge), smoothing.edge_order),
    ):
        for block in np.array_split(chosen, len(chosen) // _BLOCK + 1):
            if len(block):
                windows = first[block, None] + np.arange(width)
                out[:, block] = _fitted(
                    times_s, values, block, windows, min(order, width - 2), count
                )
    return out


def _fitted(
    times_s: Floats, values: Floats, at: Ints, windows: Ints, order: int, count: int
) -> Floats:
    """(count+1, N, C): value and derivatives at the frames `at` (N,) by the frames of their `windows` (N,W)."""
    apart_s = times_s[windows] - times_s[at][:, None]
    scale_s = np.abs(apart_s).max(axis=1, keepdims=True)
    # of equal distances one solution for all: of a steady clock there are few
    relative, which = np.unique(np.round(apart_s / scale_s, 9), axis=0, return_inverse=True)
    # the least squares of all windows at once; scaled times keep it well conditioned
    solved = np.linalg.pinv(relative[..., None] ** np.arange(order + 1))
    weights = solved[which.reshape(-1), : count + 1]
    found = np.zeros((count + 1, len(at), values.shape[1]))
    factorial = 1.0
    for k in range(min(count, order) + 1):
        factorial *= max(k, 1)
        fitted = np.einsum("nw,nwc->nc", weights[:, k], values[windows])
        found[k] = fitted * factorial / scale_s**k
    return found


def peak(times_s: Floats, values: Floats, at: int) -> tuple[float, float]:
    """Time [s] and value of the maximum about the frame `at`, by a parabola through it and its neighbours."""
    if not 0 < at < len(values) - 1 or not np.isfinite(values[at - 1 : at + 2]).all():
        return float(times_s[at]), float(values[at])
    t = times_s[at - 1 : at + 2] - times_s[at]
    if not 1 / 3 < t[2] / -t[0] < 3:  # beside a gap
        return float(times_s[at]), float(values[at])
    a, b, c = np.polyfit(t, values[at - 1 : at + 2], 2)
    if a >= 0.0 or not t[0] < -b / (2 * a) < t[2]:
        return float(times_s[at]), float(values[at])
    best_s = -b / (2 * a)
    return float(times_s[at] + best_s), float(c - b * b / (4 * a))
