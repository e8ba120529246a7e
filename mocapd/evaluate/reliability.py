"""Reliability of the confidence: the joints' errors over their confidence."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.score import JOINT_SETS, joint_errors_m, match
from mocapd.types import Floats, Ints

TENTHS = 10
NEAR_CM = 5.0  # error that is acceptable for a game


@dataclass(frozen=True, slots=True, eq=False)
class Reliability:
    """For each tenth of confidence (10,), lowest first: the number of joints, their RMS error, and the share (0..1) within
    NEAR_CM; NaN without joints."""

    count: Ints
    rms_cm: Floats
    near: Floats


def reliability(results: Sequence[CaptureResult], joints: str = "upper") -> Reliability:
    """The reliability over all captures together. Raises InputError when a track lacks one of the joints."""
    pairs = [_confidence_and_error(result, joints) for result in results]
    confidence = np.concatenate([c.ravel() for c, _ in pairs])
    error_cm = np.concatenate([e.ravel() for _, e in pairs])
    tenth = np.clip((confidence * TENTHS).astype(int), 0, TENTHS - 1)
    count = np.bincount(tenth, minlength=TENTHS)
    with np.errstate(invalid="ignore"):
        rms_cm = np.sqrt(np.bincount(tenth, error_cm**2, TENTHS) / count)
        near = np.bincount(tenth, error_cm <= NEAR_CM, TENTHS) / count
    return Reliability(count, rms_cm, near)


def near_from(of: Reliability, tenth: int) -> float:
    """The share within NEAR_CM of all joints in that tenth of confidence and above."""
    above = of.count[tenth:]
    total = int(above.sum())
    return float(np.nansum(of.near[tenth:] * above) / total) if total else float("nan")


def _confidence_and_error(result: CaptureResult, joints: str) -> tuple[Floats, Floats]:
    """Confidence and error [cm] (K,J) of the joints scored."""
    track, truth = result.track, result.case.truth
    matches = match(truth, track, joints)
    columns = [list(track.joint_names).index(name) for name in JOINT_SETS[joints]]
    error_cm = 100.0 * joint_errors_m(truth, track, matches, joints)
    return track.confidence[matches.track_rows][:, columns], error_cm
