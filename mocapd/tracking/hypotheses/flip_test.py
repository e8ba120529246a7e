"""The front-back flip test: at intervals the flipped body is fitted too, and the evidence for it accumulates.

From the side both poses look nearly alike; the one that repeatedly agrees better is right.
"""

from dataclasses import dataclass

from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.tracking.ticks import Ticks


@dataclass(frozen=True, slots=True)
class FlipTestParams:
    """Interval of the tests and weights of their evidence."""

    every_s: float = 10 / 30  # between tests, in frame sets that measure no depth
    latest_s: float = 16 / 30  # the same while other hypotheses take as long in every frame set
    explained: float = 0.03  # gain of the explained share that counts as one unit of evidence
    cost: float = 100.0  # decrease of the cost that counts as one unit
    sure: float = 2.2  # accumulated evidence at which the body is flipped
    most_loss: float = 0.05  # of the explained share, that a flip may cost


class FlipTest:
    """Accumulated evidence for the flipped pose, and the time of the last test."""

    def __init__(self, params: FlipTestParams) -> None:
        self.params = params
        self.reset()

    def reset(self) -> None:
        """Clears the evidence."""
        self._evidence = 0.0
        self._last_test_tick = 0

    def is_due(self, ticks: Ticks, is_long: bool) -> bool:
        """True if a test is due; is_long: this frame set already has long optional work."""
        since, p = ticks.last - self._last_test_tick, self.params
        needed = round((p.latest_s if is_long else p.every_s) / TICK_S)
        return ticks.alternates(2, 1) and since >= needed

    def record_test(self, ticks: Ticks) -> None:
        """Records the time of a test."""
        self._last_test_tick = ticks.last

    def is_better(self, fit: Fit, other: Fit) -> bool:
        """True if the flipped fit should replace the fit."""
        p = self.params
        gain = (other.explained - fit.explained) / p.explained + (fit.cost - other.cost) / p.cost
        self._evidence = max(self._evidence + gain, 0.0)
        return self._evidence > p.sure and other.explained > fit.explained - p.most_loss
