"""What is left of confidence while the views contradict each other for good."""

import numpy as np

from mocapd.tracking.tracking_state import lower_confidence
from mocapd.types import BodyState, Pose, Tracking


def body() -> BodyState:
    pose = Pose(np.zeros(3), np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
    return BodyState(
        0, Tracking.LIVE, "x", pose, np.zeros((2, 3)), np.array([0.8, 0.2]), (), 0, np.array([0.02, np.inf])
    )  # fmt: skip


def test_views_that_agree_change_nothing() -> None:
    known = body()
    assert lower_confidence(known, 0.0) is known


def test_confidence_falls_and_uncertainty_holds_the_contradiction() -> None:
    out = lower_confidence(body(), 0.18)
    assert (out.confidence < 0.1).all()
    assert out.uncertainty_m[0] >= 0.18
    assert np.isinf(out.uncertainty_m[1])
    assert out.tracking is Tracking.LIVE
