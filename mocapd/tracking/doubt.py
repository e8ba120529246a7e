"""What is left of a body's confidence while the cameras' views contradict each other for good."""

from dataclasses import replace

import numpy as np

from mocapd.types import BodyState

_HALF_M = 0.05  # a contradiction that halves confidence


def doubted(body: BodyState, off_m: float) -> BodyState:
    """A body whose joints may be off by `off_m` [m] more than its tracker knows: views that contradict each other find a pose
    between them, in which each joint is well confirmed."""
    if off_m <= 0.0 or body.pose is None:
        return body
    confidence = body.confidence / (1.0 + (off_m / _HALF_M) ** 2)
    return replace(body, confidence=confidence, uncertainty_m=np.hypot(body.uncertainty_m, off_m))
