"""What a confidence is worth, from tracks of known errors."""

from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.reliability import TENTHS, near_from, reliability
from mocapd.evaluate.report import reliability_table
from tests.evaluate.results import result_of


def believed(name: str, error_m: float, confidence: float) -> CaptureResult:
    result = result_of(name, error_m)
    sure = np.full_like(result.track.confidence, confidence)
    return replace(result, track=replace(result.track, confidence=sure))


def test_errors_are_told_by_the_confidence_they_had() -> None:
    of = reliability([believed("sure", 0.02, 0.95), believed("unsure", 0.12, 0.25)])
    assert of.count.sum() == of.count[9] + of.count[2]
    assert of.count[9] == of.count[2] > 0
    np.testing.assert_allclose(of.rms_cm[[2, 9]], [12.0, 2.0])
    np.testing.assert_array_equal(of.near[[2, 9]], [0.0, 1.0])
    assert np.isnan(np.delete(of.rms_cm, [2, 9])).all()
    assert near_from(of, 8) == 1.0
    assert near_from(of, 0) == 0.5
    lines = reliability_table(of).splitlines()
    assert len(lines) == 2 + TENTHS
    assert lines[2].split("|")[1].strip() == "0.9 to 1.0"
    assert lines[2].split("|")[3].strip() == "2.00"


def test_only_the_joints_that_are_scored_count() -> None:
    result = believed("sure", 0.02, 0.95)
    confidence = result.track.confidence.copy()
    confidence[:, INDEX["leftFoot"]] = 0.05
    confidence[:, INDEX["leftHand"]] = 0.05
    result = replace(result, track=replace(result.track, confidence=confidence))
    upper, legs = (reliability([result], joints) for joints in ("upper", "legs"))
    assert 0 < upper.count[0] < upper.count[9]
    assert legs.count[0] == upper.count[0]  # one hand, one foot
