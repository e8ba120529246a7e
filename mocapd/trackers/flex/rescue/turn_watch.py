"""Whether the body that is tracked faces the other way: now and then it is fitted turned round, and compared.

From the side both ways look nearly alike; which one agrees better, time after time, is right.
"""

from dataclasses import dataclass

from mocapd.fit.solver import Fit


@dataclass(frozen=True, slots=True)
class TurnWatchParams:
    """When to look, and what a look tells."""

    every: int = 10  # turns from one look to the next, at an odd one: depths are seen at even ones
    explained: float = 0.03  # so much more that is explained speaks as loud as ...
    cost: float = 100.0  # ... a cost that is so much less
    sure: float = 2.2  # of what spoke for the other way, and was not taken back, in these measures
    most_loss: float = 0.05  # of what is explained, by a body that is turned round for its cost


class TurnWatch:
    """How much spoke for the other way, which is all of its state."""

    def __init__(self, params: TurnWatchParams) -> None:
        self.params = params
        self.reset()

    def reset(self) -> None:
        """Nothing did."""
        self._other_way = 0.0

    def is_due(self, turn: int) -> bool:
        """Whether to look at this running number of a turn."""
        return turn % self.params.every == self.params.every // 2

    def is_turned(self, fit: Fit, other: Fit) -> bool:
        """Whether to go on from the other fit, of the body turned round."""
        p = self.params
        gained = (other.explained - fit.explained) / p.explained + (fit.cost - other.cost) / p.cost
        self._other_way = max(self._other_way + gained, 0.0)
        return self._other_way > p.sure and other.explained > fit.explained - p.most_loss
