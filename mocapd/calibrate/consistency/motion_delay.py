"""Estimates delays between cameras from the amount of motion in each at every instant.

The start or end of a movement, or a change of a lamp, appears in all cameras at the same instant, from any viewpoint.
The signals are correlated over trial delays; leaving out parts of the recording in turn gives the standard deviation of
the best one (jackknife).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import cv2
import numpy as np

from mocapd.types import Bytes, Floats, Singles

_WIDTH_PX = 160
_NOISE = 4.0  # of a smoothed grey value, 0..255
_QUIET = 200.0  # added before the logarithm: below it motion is noise
_GRID_S = 1.0 / 120.0
_MOST_S = (0.75, 1.5)  # trial delays,
_MOST_SHARE = 0.15  # of the common recording
_FAST_S, _SLOW_S = 0.04, 0.27  # the pass band of motion
_BLOCKS = 8
_LEAST_S = 3.0  # of a common recording, besides what delays cut off
_PEAK_S = 0.1  # about a peak of correlation, which is no rival of itself
_EDGE_S = 0.05  # a peak nearer to the last trial delay may lie beyond it
# correlation of two cameras that count, and of its next best at most
_LEAST_PEAK, _CLEAR = 0.35, 0.85


@dataclass(frozen=True, slots=True, eq=False)
class MotionSignal:
    """The amount of motion in one camera's pictures: at times_s (N,) [s], log of the change (N,)."""

    times_s: Floats
    change: Floats


@dataclass(frozen=True, slots=True)
class CameraDelay:
    """late_s: by how much the camera's times are too early (negative: too late); sd_s: its standard deviation by the
    jackknife; agreement: correlation with the others at this delay, and at none; rival: the highest correlation at any
    delay farther off."""

    late_s: float
    sd_s: float
    agreement: float
    agreement_undelayed: float
    rival: float


class MotionMeter:
    """Takes one camera's pictures in order."""

    def __init__(self) -> None:
        self._before: tuple[float, Singles] | None = None
        self._times_s: list[float] = []
        self._change: list[float] = []

    def put(self, t_s: float, picture: Bytes) -> None:
        """A picture (h,w,3) of a time [s]."""
        h, w = picture.shape[:2]
        small = cv2.resize(
            picture, (_WIDTH_PX, max(1, h * _WIDTH_PX // w)), interpolation=cv2.INTER_AREA
        )
        grey = cv2.GaussianBlur(
            cv2.cvtColor(small, cv2.COLOR_BGR2GRAY).astype(np.float32), (0, 0), 1.0
        )
        if self._before is not None and t_s > self._before[0]:
            before_s, before = self._before
            off = np.abs(grey - before)
            off[off < _NOISE] = 0.0
            self._times_s.append(0.5 * (t_s + before_s))
            self._change.append(float(np.log(off.sum() + _QUIET)))
        self._before = (t_s, np.asarray(grey, np.float32))

    def signal(self) -> MotionSignal:
        """Of all pictures so far."""
        return MotionSignal(np.array(self._times_s), np.array(self._change))


def camera_delays(signals: Sequence[MotionSignal]) -> list[CameraDelay | None]:
    """The delay of each camera relative to the others, whose median is 0. None for an undetermined one.

    Only pairs of cameras with a clear common peak count. Cameras that no chain of such pairs connects with most of the
    others see other things, so their delay is undetermined.
    """
    count = len(signals)
    correlations = _pair_blocks(signals)
    if correlations is None:
        return [None] * count
    lags_s, blocks = correlations
    curves = blocks.sum(axis=-1)
    weights = _weights(lags_s, curves)
    joined = _largest_group(weights)
    late = _solve(lags_s, curves, weights, joined)
    others = np.array(
        [
            _solve(lags_s, np.delete(blocks, k, axis=-1).sum(axis=-1), weights, joined)
            for k in range(_BLOCKS)
        ]
    )
    sd = np.sqrt((_BLOCKS - 1) / _BLOCKS * ((others - others.mean(axis=0)) ** 2).sum(axis=0))
    return [
        _judge_delay(lags_s, curves, weights, late, i, float(sd[i])) if joined[i] else None
        for i in range(count)
    ]


def _judge_delay(
    lags_s: Floats, curves: Floats, weights: Floats, late: Floats, i: int, sd_s: float
) -> CameraDelay:
    mine = _about(lags_s, curves, weights, late, i)
    off = np.abs(lags_s - late[i]) > _PEAK_S
    return CameraDelay(
        float(late[i]),
        sd_s,
        float(np.interp(late[i], lags_s, mine)),
        float(np.interp(0.0, lags_s, mine)),
        float(mine[off].max()),
    )


def _about(lags_s: Floats, curves: Floats, weights: Floats, late: Floats, i: int) -> Floats:
    """(L,): mean correlation of camera i with the others, which are late by `late` (N,), over its own delay."""
    each = [
        np.interp(lags_s, lags_s + late[j], curves[i, j], left=0.0, right=0.0)
        for j in range(len(late))
    ]
    return np.asarray(np.average(each, axis=0, weights=weights[i]), np.float64)


def _weights(lags_s: Floats, curves: Floats) -> Floats:
    """(N,N): the weight of each pair's curve, 0 without a clear peak."""
    count = len(curves)
    out = np.zeros((count, count))
    for i, j in combinations(range(count), 2):
        k = int(curves[i, j].argmax())
        peak = float(curves[i, j, k])
        rival = float(curves[i, j][np.abs(lags_s - lags_s[k]) > _PEAK_S].max())
        inside = abs(lags_s[k]) < lags_s[-1] - _EDGE_S
        if inside and peak > _LEAST_PEAK and rival < _CLEAR * peak:
            out[i, j] = out[j, i] = peak * (peak - max(rival, 0.0))
    return out


def _largest_group(weights: Floats) -> np.ndarray:
    """(N,): the cameras of the largest group that pairs of non-zero weight connect."""
    count = len(weights)
    reach = np.linalg.matrix_power((weights > 0.0) + np.eye(count), count) > 0.0
    group = reach[int(reach.sum(axis=1).argmax())]
    return group if group.sum() > 1 else np.zeros(count, bool)


def _pair_blocks(signals: Sequence[MotionSignal]) -> tuple[Floats, Floats] | None:
    """Lags (L,) [s] and (N,N,L,B): the contribution of each block of time to the correlation of camera i, late by each
    lag, with camera j."""
    if len(signals) < 2 or any(len(signal.times_s) < 10 for signal in signals):
        return None
    begin = max(float(signal.times_s[0]) for signal in signals)
    end = min(float(signal.times_s[-1]) for signal in signals)
    most_s = float(np.clip(_MOST_SHARE * (end - begin), *_MOST_S))
    if end - begin - 2.0 * most_s < _LEAST_S:
        return None
    grid_s = np.arange(begin, end, _GRID_S)
    banded = [_band(np.interp(grid_s, signal.times_s, signal.change)) for signal in signals]
    n = round(most_s / _GRID_S)
    inner = len(grid_s) - 2 * n
    cuts = np.linspace(0, inner, _BLOCKS + 1).astype(int)[:-1]
    out = np.zeros((len(signals), len(signals), 2 * n + 1, _BLOCKS))
    for i, a in enumerate(banded):
        # late by a lag: its view at t - lag is the other one's at t
        moved = np.lib.stride_tricks.sliding_window_view(a, inner)[::-1]
        for j, b in enumerate(banded):
            if i == j:
                continue
            still = b[n : n + inner]
            scale = np.maximum(np.sqrt((still**2).sum() * (moved**2).sum(axis=1)), 1e-9)
            out[i, j] = np.add.reduceat(still * moved, cuts, axis=1) / scale[:, None]
    lags_s = np.arange(-n, n + 1, dtype=np.float64) * _GRID_S
    return lags_s, out


def _band(values: Floats) -> Floats:
    """Band-pass filter: removes slow changes and noise."""
    fast, slow = _FAST_S / _GRID_S, _SLOW_S / _GRID_S
    column = values[None].astype(np.float64)
    smooth = cv2.GaussianBlur(column, (0, 0), fast, borderType=cv2.BORDER_REPLICATE)
    drift = cv2.GaussianBlur(column, (0, 0), slow, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth - drift, np.float64).reshape(-1)


def _solve(lags_s: Floats, curves: Floats, weights: Floats, joined: np.ndarray) -> Floats:
    """The delays (N,) [s] of the best correlation over pairs (N,N,L), by coordinate ascent from no delay; 0 for
    unconnected cameras."""
    late = np.zeros(len(curves))
    those = np.flatnonzero(joined)
    for _ in range(2 * len(those)):
        best = (1e-6, 0, 0.0)
        for i in those[1:] if len(those) == 2 else those:
            mine = _about(lags_s, curves, weights, late, i)
            k = int(mine.argmax())
            gain = float(mine[k] - np.interp(late[i], lags_s, mine))
            if gain > best[0]:
                best = (gain, i, _peak(lags_s, mine, k))
        if best[0] <= 1e-3:
            break
        late[best[1]] = best[2]
    if len(those) > 2:
        late[those] -= np.median(late[those])
    return late


def _peak(lags_s: Floats, curve: Floats, k: int) -> float:
    """The sub-sample peak of a curve, by a parabola over the highest point and its neighbours."""
    if not 0 < k < len(curve) - 1:
        return float(lags_s[k])
    a, b, c = curve[k - 1 : k + 2]
    bend = a - 2 * b + c
    return float(lags_s[k] + (0.5 * (a - c) / bend if bend < 0 else 0.0) * _GRID_S)
