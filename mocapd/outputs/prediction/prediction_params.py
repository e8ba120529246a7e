"""What every output lets a user set of prediction."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from mocapd.errors import ConfigError


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictionParams:
    """Whether poses are predicted for this output.

    predict_hz: send predicted poses so many times a second, also between the cameras' frames [Hz]; 0: each as it was seen
    predict_ahead_ms: with predict_hz, how long after it is sent a pose will be on the screen [ms]
    """

    predict_hz: Annotated[float, Meta(ge=0, le=240)] = 0.0
    predict_ahead_ms: Annotated[float, Meta(ge=0, le=100)] = 0.0


def check_cap(params: PredictionParams, rate_hz: float, output: str) -> None:
    """Raises ConfigError where an output is to be sent more than its own rate lets through."""
    if params.predict_hz > rate_hz:
        raise ConfigError(
            f"{params.predict_hz:g} Hz, but {output}.rate_hz lets {rate_hz:g} Hz through",
            f"{output}.predict_hz",
            f"set {output}.rate_hz = {params.predict_hz:g} too",
        )
