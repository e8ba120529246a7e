"""Estimates the clock offset between two cameras from the board's motion before both.

Each camera's intrinsics alone give the board's poses in its frame. For two cameras at rest one transform relates them, but
only between simultaneous pictures. So trial offsets are compared by how well one transform explains all pictures. A camera
that loses frames without a trace in its stamps jumps from one offset to another: the offsets over time are the cheapest
path through the trials (Viterbi algorithm), in which each jump has its price.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.time_alignment.board_alignment import Affine, align_affine
from mocapd.calibrate.time_alignment.board_track import BoardTrack
from mocapd.types import Floats, Ints

MOST_OFFSET_S = 10.0  # of two recordings with a manual start
_MOST_INDICES = 300  # of numbers of single pictures
FEWEST_PAIRS = 6  # simultaneous pictures for a transform
_PHASES = 4  # trial offsets in a period, after finding its whole periods
_DRIFT_S = 1.0  # largest sum of jumps, to either side
_ROUGH_ROWS = 90  # pictures for trying all offsets,
_FINE_ROWS = 600  # and those near the best
_WINDOW_S = 3.0  # stretches of a recording without lost frames,
_FEWEST_IN_WINDOW = 10
_MOST_WINDOWS = 10
_CANDIDATES = 3  # trial offsets of each stretch to try on all of it
_REFINED = 3  # of them to refine
_ROUNDS = 4
_LEAST_PX = 0.5  # deviation of a corner of a pose, at least
_LOOSE = 1.5  # deviations that count as one
_WRONG = 9.0  # squared deviations, upper bound of a picture's cost
_UNKNOWN = 5.0  # cost of a picture without a partner: more than a good one, less than a wrong one
_JUMP = 25.0  # cost of a jump: some wrong pictures
_SURE = 25.0  # least advantage in cost of a sure offset


@dataclass(frozen=True, slots=True, eq=False)
class PairOffsets:
    """Offsets of two cameras a and b: a picture of a at time t [s] is simultaneous with b's at t + offset.

    times_s, offset_s (T,): of some of a's pictures. jumps (J,): rows of them at which it changes. pairs:
    pictures of a with a partner that fits. sure: other offsets are much worse; refuted: zero offset is much worse.
    """

    times_s: Floats
    offset_s: Floats
    jumps: Ints
    pairs: int
    sure: bool
    refuted: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """Trial offsets by row (T,), their cost, transform and deviation [px]."""

    cost: float
    trials: Ints
    a_from_b: Affine
    scale_px: float


class _Trials:
    """The board in b's frame at each of K trial offsets from each of T pictures of a."""

    def __init__(self, a: BoardTrack, b: BoardTrack, offset_s: Floats, phases: int) -> None:
        self.a, self.b, self.offset_s, self.phases = a, b, offset_s, phases
        self.step_s = float(offset_s[1] - offset_s[0]) if len(offset_s) > 1 else 0.0
        points_m = b.at(a.times_s[:, None] + offset_s)  # (T,K,4,3)
        self.has_partner = np.isfinite(points_m[:, :, 0, 0])
        self.points_m: Floats = np.nan_to_num(points_m, nan=1.0)
        self.pixels_a = a.pixels(a.points_m)[:, None]  # (T,1,4,2)
        self.pixels_b = b.pixels(self.points_m)

    def error_px(self, a_from_b: Affine) -> Floats:
        """(T,K): reprojection error of the corners, from each camera into the other; NaN without a partner."""
        in_a = self.a.pixels(a_from_b.apply(self.points_m)) - self.pixels_a
        in_b = self.b.pixels(a_from_b.inverse().apply(self.a.points_m))[:, None] - self.pixels_b
        # mean of four corners and two cameras; einsum is much faster than sums along short axes
        square = np.einsum("tkci,tkci->tk", in_a, in_a) + np.einsum("tkci,tkci->tk", in_b, in_b)
        square *= 1.0 / 8.0
        return np.where(self.has_partner, np.sqrt(square), np.nan)

    def costs(self, a_from_b: Affine, scale_px: float) -> Floats:
        """(T,K) in squared deviations."""
        square = np.square(self.error_px(a_from_b) / (_LOOSE * scale_px))
        return np.where(self.has_partner, np.minimum(square, _WRONG), _UNKNOWN)


def find_offsets(a: BoardTrack, b: BoardTrack) -> PairOffsets | None:
    """None where the two have too few common pictures of the board, at any offset."""
    if len(a.times_s) < FEWEST_PAIRS or len(b.times_s) < FEWEST_PAIRS:
        return None
    step_s = min(a.period_s, b.period_s)
    is_followed = a.followed and b.followed
    first_s, last_s = b.times_s[0] - a.times_s[-1], b.times_s[-1] - a.times_s[0]
    most = int(MOST_OFFSET_S / step_s) if is_followed else _MOST_INDICES
    most = min(most, int(max(-first_s, last_s, 0.0) / step_s) + 1)
    rough, finer = a.thin(_ROUGH_ROWS), a.thin(_FINE_ROWS)
    coarse_s: Floats = step_s * np.arange(-most, most + 1, dtype=np.float64)
    trials = _Trials(rough, b, coarse_s, 1)
    candidates = [fit for rows in _windows(rough) for fit in _fitting(trials, rows)]
    if not candidates:
        return None
    scale_px = max(_LEAST_PX, min(px for px, _ in candidates[:_CANDIDATES]))
    paths = sorted((_best_path(trials, M, scale_px) for _, M in candidates), key=lambda p: p.cost)
    paths = [_refine(trials, path) for path in paths[:_REFINED]]
    path = min(paths, key=lambda p: p.cost / _LOOSE**2 + len(p.trials) * np.log(p.scale_px))
    middle_s = float(np.median(trials.offset_s[path.trials]))
    # zero is among the trials
    phases = _PHASES if is_followed else 1
    lowest, highest = min(middle_s - _DRIFT_S, 0.0), max(middle_s + _DRIFT_S, 0.0)
    if not is_followed:
        lowest, highest = -most * step_s, most * step_s
    fine = np.arange(round(phases * lowest / step_s), round(phases * highest / step_s) + 1)
    fine_s: Floats = (step_s / phases) * fine.astype(np.float64)
    trials = _Trials(finer, b, fine_s, phases)
    path = _refine(trials, _best_path(trials, path.a_from_b, path.scale_px))
    return _make_offsets(trials, path)


def _windows(a: BoardTrack) -> list[Ints]:
    """Rows of a's pictures: all of them, and stretches of a few seconds."""
    times_s = a.times_s
    rows = np.arange(len(times_s))
    out = [rows]
    starts = np.arange(times_s[0], times_s[-1] - 0.5 * _WINDOW_S, 0.5 * _WINDOW_S)
    for start_s in starts[:: max(1, -(-len(starts) // _MOST_WINDOWS))]:
        inside = rows[(times_s >= start_s) & (times_s < start_s + _WINDOW_S)]
        if len(inside) < _FEWEST_IN_WINDOW:
            inside = rows[times_s >= start_s][:_FEWEST_IN_WINDOW]
        if FEWEST_PAIRS <= len(inside) < 0.8 * len(rows):
            out.append(inside)
    return out


def _fitting(trials: _Trials, rows: Ints) -> list[tuple[float, Affine]]:
    """Error [px] and a_from_b of the best trial offsets for these pictures, distinct from each other."""
    has_partner = trials.has_partner[rows]
    enough = has_partner.sum(axis=0) >= max(FEWEST_PAIRS, 0.3 * has_partner.sum(axis=0).max())
    if not enough.any():
        return []
    columns = np.flatnonzero(enough)
    has_partner = has_partner[:, columns]
    a_m, b_m = trials.a.points_m[rows], trials.points_m[np.ix_(rows, columns)]
    weight = has_partner.astype(float)
    for _ in range(3):
        a_from_b = align_affine(a_m, b_m, weight)
        off_px = trials.a.pixels(a_from_b.apply(b_m)) - trials.pixels_a[rows]
        error = np.sqrt(np.einsum("tkci,tkci->tkc", off_px, off_px)).mean(axis=2)
        error[~has_partner] = np.nan
        middle = np.nanmedian(error, axis=0)
        square = np.square(np.where(has_partner, error, np.inf) / (_LOOSE * middle + 1e-9))
        weight = 1.0 / (1.0 + square)
    out = []
    for _ in range(_CANDIDATES):
        best = int(np.argmin(middle))
        if not np.isfinite(middle[best]):
            break
        out.append((float(middle[best]), a_from_b[best]))
        middle[abs(columns - columns[best]) < 2] = np.inf
    return out


def _best_path(trials: _Trials, a_from_b: Affine, scale_px: float) -> _Path:
    """The cheapest path, with jumps by whole periods."""
    costs = trials.costs(a_from_b, scale_px)
    paths = []
    for phase in range(trials.phases):
        total, states = _cheapest(costs[:, phase :: trials.phases])
        paths.append(_Path(total, phase + trials.phases * states, a_from_b, scale_px))
    return min(paths, key=lambda path: path.cost)


def _cheapest(costs: Floats) -> tuple[float, Ints]:
    """Cost of the cheapest path through states (T,K), and the states (T,)."""
    total = costs[0].copy()
    came = np.zeros(costs.shape, np.int64)
    stay = np.arange(costs.shape[1])
    for t in range(1, len(costs)):
        best = int(np.argmin(total))
        jump = total[best] + _JUMP < total
        came[t] = np.where(jump, best, stay)
        total = np.where(jump, total[best] + _JUMP, total) + costs[t]
    states = np.zeros(len(costs), np.int64)
    states[-1] = int(np.argmin(total))
    for t in range(len(costs) - 1, 0, -1):
        states[t - 1] = came[t, states[t]]
    return float(total.min()), states


def _refine(trials: _Trials, path: _Path) -> _Path:
    """The transform and deviation from all pictures along the path, and the path under these."""
    rows = np.arange(len(path.trials))
    for _ in range(_ROUNDS):
        error = trials.error_px(path.a_from_b)[rows, path.trials]
        has_partner = np.isfinite(error)
        if has_partner.sum() < FEWEST_PAIRS:
            return path
        error = np.where(has_partner, error, np.inf)
        for _ in range(2):
            scale_px = max(_LEAST_PX, float(np.median(error[has_partner])))
            weight = 1.0 / (1.0 + np.square(error / (_LOOSE * scale_px)))
            b_m = trials.points_m[rows, path.trials][:, None]
            a_from_b = align_affine(trials.a.points_m, b_m, weight[:, None])[0]
            error = np.where(has_partner, trials.error_px(a_from_b)[rows, path.trials], np.inf)
        before, path = path, _best_path(trials, a_from_b, scale_px)
        if (path.trials == before.trials).all() and scale_px > 0.95 * before.scale_px:
            break
    return path


def _make_offsets(trials: _Trials, path: _Path) -> PairOffsets:
    costs = trials.costs(path.a_from_b, path.scale_px)
    rows = np.arange(len(path.trials))
    path = replace(path, trials=_drop_unsupported_jumps(path.trials, costs, trials.has_partner))
    jumps = np.flatnonzero(np.diff(path.trials)) + 1
    error = trials.error_px(path.a_from_b)[rows, path.trials]
    good = np.isfinite(error) & (error < _LOOSE * np.sqrt(_WRONG) * path.scale_px)
    # cost of alternatives: this whole path, shifted by a period and more
    others = [
        float(costs[rows, np.clip(path.trials + shift, 0, costs.shape[1] - 1)].sum())
        for shift in np.arange(-costs.shape[1] + 1, costs.shape[1])
        if abs(shift) >= trials.phases
    ]
    own = float(costs[rows, path.trials].sum())
    zero = int(np.argmin(np.abs(trials.offset_s)))
    sure = good.sum() >= FEWEST_PAIRS and (not others or min(others) > own + _SURE)
    refuted = float(costs[:, zero].sum()) > own + _SURE
    return PairOffsets(
        trials.a.times_s,
        trials.offset_s[path.trials] + _between_trials_s(trials, path),
        jumps,
        int(good.sum()),
        bool(sure),
        refuted,
    )


def _between_trials_s(trials: _Trials, path: _Path) -> float:
    """Sub-trial offset of the whole path [s]: the minimum of a parabola through three trials."""
    if trials.phases == 1:
        return 0.0
    rows, last = np.arange(len(path.trials)), len(trials.offset_s) - 1
    fits = []
    for shift in (-2, 0, 2):
        at = np.clip(path.trials + shift, 0, last)
        a_from_b, error = path.a_from_b, np.zeros(0)
        for _ in range(2):
            error = trials.error_px(a_from_b)[rows, at]
            square = np.square(error / (_LOOSE * path.scale_px))
            weight = np.where(trials.has_partner[rows, at], 1.0 / (1.0 + square), 0.0)
            b_m = trials.points_m[rows, at][:, None]
            a_from_b = align_affine(trials.a.points_m, b_m, weight[:, None])[0]
        square = np.square(trials.error_px(a_from_b)[rows, at] / path.scale_px)
        has_partner = square[np.isfinite(square)]
        if not len(has_partner):
            return 0.0
        fits.append(float(np.minimum(has_partner, _WRONG).mean()))
    before, here, after = fits
    bend = before - 2.0 * here + after
    if bend <= 0.0:
        return 0.0
    return float(np.clip((before - after) / bend, -1.0, 1.0) * trials.step_s)


def _drop_unsupported_jumps(states: Ints, costs: Floats, has_partner: NDArray[np.bool_]) -> Ints:
    """The path without jumps that only pictures without a partner before or after support.

    Of two successive stretches, the one that loses least takes the other's offset.
    """
    states = states.copy()
    while True:
        edges = np.concatenate([[0], np.flatnonzero(np.diff(states)) + 1, [len(states)]]).tolist()
        worth = []
        for k in range(1, len(edges) - 1):
            for own, other in ((k - 1, k), (k, k - 1)):
                rows = np.arange(edges[own], edges[own + 1])
                here, there = states[edges[own]], states[edges[other]]
                both = rows[has_partner[rows, here] & has_partner[rows, there]]
                loss = float((costs[both, there] - costs[both, here]).sum())
                worth.append((loss, edges[own], edges[own + 1], int(there)))
        if not worth or min(worth)[0] >= _JUMP:
            return states
        _, start, end, there = min(worth)
        states[start:end] = there
