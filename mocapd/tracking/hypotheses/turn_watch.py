"""Whether the body that is tracked faces the other way: now and then it is fitted turned round, and compared.

From the side both ways look nearly alike; which one agrees better, time after time, is right.
"""

from dataclasses import dataclass

from mocapd.fit.fit_result import Fit


@dataclass(frozen=True, slots=True)
class TurnWatchParams:
    """When to look, and what a look tells."""

    every: int = 10  # turns from one look to the next, at an odd one: depths are seen at even ones
    latest: int = 16  # the same while each frame has other things to try, which take as long
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
        self._looked = 0

    def is_due(self, turn: int, is_long: bool) -> bool:
        """Whether to look at this running number of a turn; is_long: its frame takes long without that."""
        since, p = turn - self._looked, self.params
        return turn % 2 == 1 and since >= (p.latest if is_long else p.every)

    def looked(self, turn: int) -> None:
        """It did."""
        self._looked = turn

    def is_turned(self, fit: Fit, other: Fit) -> bool:
        """Whether to go on from the other fit, of the body turned round."""
        p = self.params
        gained = (other.explained - fit.explained) / p.explained + (fit.cost - other.cost) / p.cost
        self._other_way = max(self._other_way + gained, 0.0)
        return self._other_way > p.sure and other.explained > fit.explained - p.most_loss
