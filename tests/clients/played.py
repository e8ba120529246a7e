"""What a client made of the streams that it was played."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mocapd.types import Floats


@dataclass(frozen=True)
class Played:
    """One stream. Every client prints the same: this is what it is read into."""

    steps: list[
        tuple[int, str]
    ]  # whose newest frame was made (-1: nobody's), and tracking of person 0
    trouble: dict[str, int]  # what was wrong, by kind
    status: str  # of person 0 at the end
    persons: dict[str, dict[str, Any]]  # the newest frame of each

    @classmethod
    def read(cls, told: dict[str, Any]) -> "Played":
        steps = [(int(person), str(tracking)) for person, tracking in told["steps"]]
        trouble = {kind: int(count) for kind, count in told["trouble"].items()}
        return cls(steps, trouble, told["status"], told["persons"])

    @property
    def frames(self) -> int:
        """How often a frame was whole."""
        return sum(person >= 0 for person, _ in self.steps)

    @property
    def tracking(self) -> str:
        """Of person 0 at the end."""
        return self.steps[-1][1]

    @property
    def joints(self) -> dict[str, dict[str, Any]]:
        """Of person 0's newest frame, by VRM 1.0 name."""
        joints: dict[str, dict[str, Any]] = self.persons["0"]["joints"]
        return joints

    def positions_m(self, person: str = "0") -> dict[str, Floats]:
        """As the client has them, in its engine's axes."""
        return {n: np.array(one["origin"]) for n, one in self.persons[person]["joints"].items()}
