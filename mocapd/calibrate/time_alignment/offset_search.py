"""How much later one camera's clock is than another's, from the board's motion before both.

Each lens alone gives the board's poses before its camera. Two cameras at rest see them through one and the same
transform, but only when pictures of one instant are compared. So trial offsets are compared by how well one
transform explains all pictures. A camera that loses frames without a trace in its stamps jumps from one offset to
another: the offsets over time are the cheapest path through the trials (Viterbi), in which each jump has its price.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.time_alignment.board_alignment import Affine, aligned
from mocapd.calibrate.time_alignment.board_track import BoardTrack
from mocapd.types import Floats, Ints

MOST_OFFSET_S = 10.0  # of two recordings that somebody started by hand
_MOST_INDICES = 300  # of numbers of pictures taken one by one
FEWEST_PAIRS = 6  # pictures of one instant, from which a transform is taken
_PHASES = 4  # trial offsets in a period, once its whole periods are known
_DRIFT_S = 1.0  # that jumps may add up to, to either side
_ROUGH_ROWS = 90  # pictures that all offsets are tried with,
_FINE_ROWS = 600  # and those near the best
_WINDOW_S = 3.0  # stretches of a recording in which no frame may be lost,
_FEWEST_IN_WINDOW = 10
_MOST_WINDOWS = 10
_CANDIDATES = 3  # trial offsets of each stretch that are tried on all of it
_REFINED = 3  # of them that are improved
_ROUNDS = 4
_LEAST_PX = 0.5  # deviation of a corner of a pose, at least
_LOOSE = 1.5  # deviations that count as one
_WRONG = 9.0  # squared deviations above which a picture is as wrong as can be
_UNKNOWN = (
    5.0  # what a picture without a partner costs: more than a good one, less than a wrong one
)
_JUMP = 25.0  # what a jump costs: some wrong pictures
_SURE = 25.0  # how much cheaper an offset must be than others


@dataclass(frozen=True, slots=True, eq=False)
class PairOffsets:
    """What two cameras a and b say: a picture of a at time t [s] is of one instant with b's at t + offset.

    times_s, offset_s (T,): of some of a's pictures. jumps (J,): rows of them before which it changes. px: usual
    error of a corner. pairs: pictures of a with a partner that fits. sure: other offsets are much worse; refuted: zero
    offset is much worse.
    """

    times_s: Floats
    offset_s: Floats
    jumps: Ints
    px: float
    pairs: int
    sure: bool
    refuted: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """Trial offsets by row (T,), what they cost, the transform and the deviation [px] that they are for."""

    cost: float
    trials: Ints
    a_from_b: Affine
    scale_px: float


class _Trials:
    """The board before b at each of K trial offsets from each of T pictures of a."""

    def __init__(self, a: BoardTrack, b: BoardTrack, offset_s: Floats, phases: int) -> None:
        self.a, self.b, self.offset_s, self.phases = a, b, offset_s, phases
        self.step_s = float(offset_s[1] - offset_s[0]) if len(offset_s) > 1 else 0.0
        points_m = b.at(a.times_s[:, None] + offset_s)  # (T,K,4,3)
        self.known = np.isfinite(points_m[:, :, 0, 0])
        self.points_m: Floats = np.nan_to_num(points_m, nan=1.0)
        self.seen_px = a.pixels(a.points_m)[:, None]  # (T,1,4,2)
        self.seen_b_px = b.pixels(self.points_m)

    def error_px(self, a_from_b: Affine) -> Floats:
        """(T,K): of the corners, as each camera sees what the other one says; NaN without a partner."""
        in_a = self.a.pixels(a_from_b.apply(self.points_m)) - self.seen_px
        in_b = self.b.pixels(a_from_b.inverse().apply(self.a.points_m))[:, None] - self.seen_b_px
        # mean of four corners and two cameras; einsum is much faster than sums along short axes
        square = np.einsum("tkci,tkci->tk", in_a, in_a) + np.einsum("tkci,tkci->tk", in_b, in_b)
        square *= 1.0 / 8.0
        out: Floats = np.where(self.known, np.sqrt(square), np.nan)
        return out

    def costs(self, a_from_b: Affine, scale_px: float) -> Floats:
        """(T,K) in squared deviations."""
        square = np.square(self.error_px(a_from_b) / (_LOOSE * scale_px))
        return np.where(self.known, np.minimum(square, _WRONG), _UNKNOWN)


def find_offsets(a: BoardTrack, b: BoardTrack) -> PairOffsets | None:
    """None where the two hardly see the board together, at any offset."""
    if len(a.times_s) < FEWEST_PAIRS or len(b.times_s) < FEWEST_PAIRS:
        return None
    step_s = min(a.period_s, b.period_s)
    is_followed = a.followed and b.followed
    first_s, last_s = b.times_s[0] - a.times_s[-1], b.times_s[-1] - a.times_s[0]
    most = int(MOST_OFFSET_S / step_s) if is_followed else _MOST_INDICES
    most = min(most, int(max(-first_s, last_s, 0.0) / step_s) + 1)
    rough, finer = a.thinned(_ROUGH_ROWS), a.thinned(_FINE_ROWS)
    coarse_s: Floats = step_s * np.arange(-most, most + 1, dtype=np.float64)
    trials = _Trials(rough, b, coarse_s, 1)
    candidates = [one for rows in _windows(rough) for one in _fitting(trials, rows)]
    if not candidates:
        return None
    scale_px = max(_LEAST_PX, min(px for px, _ in candidates[:_CANDIDATES]))
    paths = sorted((_best_path(trials, M, scale_px) for _, M in candidates), key=lambda p: p.cost)
    paths = [_refined(trials, path) for path in paths[:_REFINED]]
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
    path = _refined(trials, _best_path(trials, path.a_from_b, path.scale_px))
    return _judged(trials, path)


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
    """Error [px] and a_from_b of the trial offsets that explain these pictures best, apart from each other."""
    known = trials.known[rows]
    enough = known.sum(axis=0) >= max(FEWEST_PAIRS, 0.3 * known.sum(axis=0).max())
    if not enough.any():
        return []
    columns = np.flatnonzero(enough)
    known = known[:, columns]
    a_m, b_m = trials.a.points_m[rows], trials.points_m[np.ix_(rows, columns)]
    weight = known.astype(float)
    for _ in range(3):
        a_from_b = aligned(a_m, b_m, weight)
        off_px = trials.a.pixels(a_from_b.apply(b_m)) - trials.seen_px[rows]
        error = np.sqrt(np.einsum("tkci,tkci->tkc", off_px, off_px)).mean(axis=2)
        error[~known] = np.nan
        middle = np.nanmedian(error, axis=0)
        square = np.square(np.where(known, error, np.inf) / (_LOOSE * middle + 1e-9))
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
    """The cheapest, with jumps by whole periods."""
    costs = trials.costs(a_from_b, scale_px)
    best: tuple[float, Ints] | None = None
    for phase in range(trials.phases):
        columns = np.arange(phase, costs.shape[1], trials.phases)
        total, states = _cheapest(costs[:, columns])
        if best is None or total < best[0]:
            best = total, columns[states]
    assert best is not None
    return _Path(best[0], best[1], a_from_b, scale_px)


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


def _refined(trials: _Trials, path: _Path) -> _Path:
    """The transform taken from all pictures along the path, the deviation measured there, and the path anew."""
    rows = np.arange(len(path.trials))
    for _ in range(_ROUNDS):
        error = trials.error_px(path.a_from_b)[rows, path.trials]
        known = np.isfinite(error)
        if known.sum() < FEWEST_PAIRS:
            return path
        error = np.where(known, error, np.inf)
        for _ in range(2):
            scale_px = max(_LEAST_PX, float(np.median(error[known])))
            weight = 1.0 / (1.0 + np.square(error / (_LOOSE * scale_px)))
            b_m = trials.points_m[rows, path.trials][:, None]
            a_from_b = aligned(trials.a.points_m, b_m, weight[:, None])[0]
            error = np.where(known, trials.error_px(a_from_b)[rows, path.trials], np.inf)
        before, path = path, _best_path(trials, a_from_b, scale_px)
        if (path.trials == before.trials).all() and scale_px > 0.95 * before.scale_px:
            break
    return path


def _judged(trials: _Trials, path: _Path) -> PairOffsets:
    costs = trials.costs(path.a_from_b, path.scale_px)
    rows = np.arange(len(path.trials))
    path = replace(path, trials=_supported(path.trials, costs, trials.known))
    jumps = np.flatnonzero(np.diff(path.trials)) + 1
    error = trials.error_px(path.a_from_b)[rows, path.trials]
    good = np.isfinite(error) & (error < _LOOSE * np.sqrt(_WRONG) * path.scale_px)
    # what other paths cost: the whole of this one shifted by a period and more
    others = [
        float(costs[rows, np.clip(path.trials + shift, 0, costs.shape[1] - 1)].sum())
        for shift in np.arange(-costs.shape[1] + 1, costs.shape[1])
        if abs(shift) >= trials.phases
    ]
    own = float(costs[rows, path.trials].sum())
    zero = int(np.argmin(np.abs(trials.offset_s)))
    sure = good.sum() >= FEWEST_PAIRS and (not others or min(others) > own + _SURE)
    refuted = float(costs[:, zero].sum()) > own + _SURE
    px = float(np.median(error[good])) if good.any() else float("inf")
    return PairOffsets(
        trials.a.times_s,
        trials.offset_s[path.trials] + _between_trials_s(trials, path),
        jumps,
        px,
        int(good.sum()),
        bool(sure),
        refuted,
    )


def _between_trials_s(trials: _Trials, path: _Path) -> float:
    """Where between the trials the whole path fits best [s]: the lowest of a parabola through three."""
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
            weight = np.where(trials.known[rows, at], 1.0 / (1.0 + square), 0.0)
            b_m = trials.points_m[rows, at][:, None]
            a_from_b = aligned(trials.a.points_m, b_m, weight[:, None])[0]
        square = np.square(trials.error_px(a_from_b)[rows, at] / path.scale_px)
        known = square[np.isfinite(square)]
        if not len(known):
            return 0.0
        fits.append(float(np.minimum(known, _WRONG).mean()))
    before, here, after = fits
    bend = before - 2.0 * here + after
    if bend <= 0.0:
        return 0.0
    return float(np.clip((before - after) / bend, -1.0, 1.0) * trials.step_s)


def _supported(states: Ints, costs: Floats, known: NDArray[np.bool_]) -> Ints:
    """The path without jumps for which only pictures speak that have no partner before or after.

    Of two stretches next to each other, the one that loses least takes the other's offset.
    """
    states = states.copy()
    while True:
        edges = np.concatenate([[0], np.flatnonzero(np.diff(states)) + 1, [len(states)]]).tolist()
        worth = []
        for k in range(1, len(edges) - 1):
            for own, other in ((k - 1, k), (k, k - 1)):
                rows = np.arange(edges[own], edges[own + 1])
                here, there = states[edges[own]], states[edges[other]]
                both = rows[known[rows, here] & known[rows, there]]
                loss = float((costs[both, there] - costs[both, here]).sum())
                worth.append((loss, edges[own], edges[own + 1], int(there)))
        if not worth or min(worth)[0] >= _JUMP:
            return states
        _, start, end, there = min(worth)
        states[start:end] = there
