"""`live`, `coasting` or `lost`, from evidence and time alone; and what lowers the confidence of a body."""

import math
from dataclasses import dataclass, replace

import numpy as np

from mocapd.clock import nanoseconds
from mocapd.errors import ConfigError
from mocapd.types import BodyState, Floats, Tracking

# How fast joints leave a pose published without evidence, along an axis: of 25 clips of everyday motion and sport
# the hips 0.3, elbows 0.4, hands 0.6
DRIFT_M_S = 0.4
COAST_S = 0.5
FADE_S = 0.15  # a joint's confidence falls to 1/e in this time without evidence
_HALF_M = 0.05  # a contradiction that halves confidence


def confidence_fade(away_s: float) -> float:
    """Factor on a confidence after away_s [s] without evidence."""
    return math.exp(-away_s / FADE_S)


def grow_uncertainty(uncertainty_m: Floats, away_s: Floats | float) -> Floats:
    """Uncertainties (J,) [m] after away_s [s], of all or (J,) of each, without evidence."""
    total_m: Floats = np.hypot(uncertainty_m, DRIFT_M_S * away_s)
    return total_m


@dataclass(frozen=True, slots=True)
class TrackingStateParams:
    """coast_s: for how long after the last evidence a pose is still predicted [s].

    confirm_s: for how long every frame set must show evidence before a lost track becomes live [s]; the default is the
    third frame at 30 Hz, the second at 15 Hz.
    """

    coast_s: float = COAST_S
    confirm_s: float = 0.06

    def __post_init__(self) -> None:
        for name in ("coast_s", "confirm_s"):
            if not 0.0 <= getattr(self, name) < float("inf"):
                raise ConfigError(f"{getattr(self, name)} s", f"tracker.{name}", "give 0 or more")


class TrackingState:
    """Starts lost. Evidence makes it live after `confirm_s`; without evidence it coasts, then is lost."""

    def __init__(self, params: TrackingStateParams | None = None) -> None:
        params = params if params is not None else TrackingStateParams()
        self._coast_ns = nanoseconds(params.coast_s)
        self._confirm_ns = nanoseconds(params.confirm_s)
        self.reset()

    def reset(self, live_ns: int | None = None) -> None:
        """Lost; or live, with the last evidence at that time [ns]."""
        self.now = Tracking.LOST if live_ns is None else Tracking.LIVE
        self._evidence_ns = live_ns  # the last time there was any
        self._since_ns: int | None = None  # while lost: since when every frame had some

    def step(self, t_ns: int, evidence: bool) -> Tracking:
        """The state at `t_ns` [ns, never decreasing]. evidence: this frame set shows the person."""
        if self._evidence_ns is not None and t_ns - self._evidence_ns > self._coast_ns:
            self.reset()  # also when no frame at all came meanwhile
        if self.now is not Tracking.LOST:
            self.now = Tracking.LIVE if evidence else Tracking.COASTING
        elif not evidence:
            self._since_ns = None
        else:
            if self._since_ns is None:
                self._since_ns = t_ns
            if t_ns - self._since_ns >= self._confirm_ns:
                self.now = Tracking.LIVE
        if evidence:
            self._evidence_ns = t_ns
        return self.now


def lower_confidence(body: BodyState, off_m: float) -> BodyState:
    """The body with joints that may be off by `off_m` [m] more than its tracker estimates, while the cameras' views
    contradict each other persistently.

    A fit to contradicting views lies between them, and each view seems to confirm its joints.
    """
    if off_m <= 0.0 or body.pose is None:
        return body
    confidence = body.confidence / (1.0 + (off_m / _HALF_M) ** 2)
    return replace(body, confidence=confidence, uncertainty_m=np.hypot(body.uncertainty_m, off_m))
