"""Left against right. Pure."""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.session import Flags

LAG_S = 1.0  # how far one side may follow the other [s]


@dataclass(frozen=True, slots=True)
class SidePair:
    """One measure of both sides. index_percent: (left - right) of their mean, -200..200; 0: the same."""

    measure: str
    unit: str
    left: float
    right: float

    @property
    def index_percent(self) -> float:
        """0 where neither side moves."""
        mean = 0.5 * (self.left + self.right)
        return 100.0 * (self.left - self.right) / mean if mean > 1e-6 else 0.0


@dataclass(frozen=True, slots=True)
class Together:
    """How alike two signals run. correlation -1..1 at the same instant; best_correlation, and by how much
    the right one follows the left there [s]: both sides at once gives 0, in turn half a period."""

    correlation: float
    best_correlation: float
    right_follows_s: float


def together(times_s: Floats, left: Floats, right: Floats) -> Together | None:
    """Of two signals (F,), where both are known; None where they hardly are, or one does not move."""
    step_s = float(np.median(np.diff(times_s))) if len(times_s) > 1 else 0.0
    if step_s <= 0.0:
        return None
    at_s = np.arange(times_s[0], times_s[-1] + 0.5 * step_s, step_s)
    # an hour at 60 Hz, and no more whatever two frames that lie close say of the rate
    if not 20 <= len(at_s) <= 1_000_000:
        return None
    both = np.isfinite(left) & np.isfinite(right)
    if both.sum() < 20:
        return None
    a, b = (np.interp(at_s, times_s[both], one[both]) for one in (left, right))
    known = np.interp(at_s, times_s, both.astype(float)) > 0.5
    lags = range(-min(round(LAG_S / step_s), len(at_s) // 3), 1)
    of_lag = {
        lag: _correlation(a, b, known, lag) for lag in (*lags, *(-lag for lag in lags if lag))
    }
    if not np.isfinite(of_lag[0]):
        return None
    # of equal ones the least lag
    best = max(of_lag, key=lambda lag: (round(np.nan_to_num(of_lag[lag], nan=-2.0), 3), -abs(lag)))
    return Together(of_lag[0], of_lag[best], best * step_s)


def _correlation(a: Floats, b: Floats, known: Flags, lag: int) -> float:
    """Of a now with b `lag` frames later."""
    count = len(a) - abs(lag)
    first, later = max(-lag, 0), max(lag, 0)
    use = known[first : first + count] & known[later : later + count]
    x, y = a[first : first + count][use], b[later : later + count][use]
    if len(x) < 10 or x.std() < 1e-9 or y.std() < 1e-9:
        return float("nan")
    return float(np.corrcoef(x, y)[0, 1])
