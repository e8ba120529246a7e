"""Whether the body that is tracked faces the other way: now and then it is fitted turned round, and compared.

From the side both ways look nearly alike; which one agrees better, time after time, is right.
"""

from dataclasses import dataclass

from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.tracking.ticks import Ticks


@dataclass(frozen=True, slots=True)
class TurnWatchParams:
    """When to look, and what a look tells."""

    every_s: float = 10 / 30  # from one look to the next, in a frame that sees no depths
    latest_s: float = (
        16 / 30
    )  # the same while each frame has other things to try, which take as long
    explained: float = 0.03  # so much more that is explained speaks as loud as ...
    cost: float = 100.0  # ... a cost that is so much less
    sure: float = 2.2  # of what spoke for the other way, and was not taken back, in these measures
    most_loss: float = 0.05  # of what is explained, by a body that is turned round for its cost


class TurnWatch:
    """How much spoke for the other way, and when it looked last, which is all of its state."""

    def __init__(self, params: TurnWatchParams) -> None:
        self.params = params
        self.reset()

    def reset(self) -> None:
        """Nothing did, and it did not look yet."""
        self._other_way = 0.0
        self._looked = 0  # the tick

    def is_due(self, ticks: Ticks, is_long: bool) -> bool:
        """Whether to look in a frame set with which these ticks passed; is_long: it takes long without that."""
        since, p = ticks.last - self._looked, self.params
        needed = round((p.latest_s if is_long else p.every_s) / TICK_S)
        return ticks.alternates(2, 1) and since >= needed

    def looked(self, ticks: Ticks) -> None:
        """It did."""
        self._looked = ticks.last

    def is_turned(self, fit: Fit, other: Fit) -> bool:
        """Whether to go on from the other fit, of the body turned round."""
        p = self.params
        gained = (other.explained - fit.explained) / p.explained + (fit.cost - other.cost) / p.cost
        self._other_way = max(self._other_way + gained, 0.0)
        return self._other_way > p.sure and other.explained > fit.explained - p.most_loss
