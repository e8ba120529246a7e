"""What a user may set of prediction, for every output at once."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class PredictionParams:
    """Whether the outputs send predicted poses.

    hz: number of predicted poses per second, also between the cameras' frames [Hz]; 0: each pose as measured
    ahead_ms: with hz, the time from sending a pose until it is on the screen [ms]
    outputs: outputs with prediction; empty: all. Omit zenoh if you record
    """

    hz: Annotated[float, Meta(ge=0, le=240)] = 0.0
    ahead_ms: Annotated[float, Meta(ge=0, le=100)] = 0.0
    outputs: tuple[str, ...] = ()

    def rate_hz(self, output: str, limit_hz: float) -> float:
        """How many predicted poses an output gets a second [Hz], at most `limit_hz`; 0: none is predicted."""
        return min(self.hz, limit_hz) if not self.outputs or output in self.outputs else 0.0
