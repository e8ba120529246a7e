"""What the fit sums up: something that holds or pulls the body."""

from typing import Protocol

from mocapd.body.arrays import PosedJoints
from mocapd.body.model import Shaped
from mocapd.types import Floats


class Term(Protocol):
    """What a term must do; it has no state of earlier poses.

    is_measured: whether its rows were measured for one pose, so that its cost is invalid far from it.
    """

    is_measured: bool

    def add(self, posed: PosedJoints, body: Shaped, H: Floats, b: Floats, /) -> float:
        """Add its rows at this pose to H (P,P) and b (P,), the pose's unknowns first: the step H^-1 b makes the
        residuals smaller. Its cost, in the unit of the id maps' rows: information times squared residual."""
        ...
