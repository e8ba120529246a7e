"""Lowers a body's confidence while the cameras' views contradict each other persistently."""

from dataclasses import replace

import numpy as np

from mocapd.types import BodyState

_HALF_M = 0.05  # a contradiction that halves confidence


def lower_confidence(body: BodyState, off_m: float) -> BodyState:
    """The body with joints that may be off by `off_m` [m] more than its tracker estimates.

    A fit to contradicting views lies between them, and each view seems to confirm its joints.
    """
    if off_m <= 0.0 or body.pose is None:
        return body
    confidence = body.confidence / (1.0 + (off_m / _HALF_M) ** 2)
    return replace(body, confidence=confidence, uncertainty_m=np.hypot(body.uncertainty_m, off_m))
