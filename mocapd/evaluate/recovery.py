"""Recovery time of a tracker after a change of light or an occlusion."""

import math

import numpy as np

from mocapd.evaluate.score import joint_errors_m, match
from mocapd.evaluate.truth import Truth
from mocapd.session.offline import RecordedTrack
from mocapd.types import Floats

LIMIT_M = 0.06
# after an occlusion of the whole body, where even good tracks have larger errors
CLEAR_LIMIT_M = 0.10
STEADY_FRAMES = 3
# An error that rises later than this after the change has another cause, such as a fast throw.
_BLAMED_FRAMES = 10


def frame_errors_m(truth: Truth, track: RecordedTrack, joints: str = "upper") -> Floats:
    """RMS error (F,) [m] of the joints in each frame of the truth; infinite where nothing was tracked.

    NaN outside the scored frames.
    """
    matches = match(truth, track, joints)
    errors = np.full(len(truth.times_s), np.nan)
    errors[matches.rows] = np.inf
    squares = joint_errors_m(truth, track, matches, joints) ** 2
    errors[matches.truth_rows] = np.sqrt(squares.mean(axis=1))
    return errors


def recovery_frames(errors_m: Floats, limit_m: float = LIMIT_M, for_good: bool = False) -> float:
    """Frames until the error is back under the limit, of errors_m (N,) from the change on.

    0 when it did not exceed the limit shortly after the change, infinite when it did not recover. Recovered means under
    the limit for three frames, or to the end of the recording. for_good: only to the end, and 0 when it never exceeded
    the limit.
    """
    over = ~(errors_m < limit_m)
    if for_good:
        if len(over) and over[-1]:
            return math.inf
        return float(len(over) - over[::-1].argmax()) if over.any() else 0.0
    if not over[:_BLAMED_FRAMES].any():
        return 0.0
    left = int(over.argmax())
    for frame in range(left + 1, len(over)):
        if not over[frame : frame + STEADY_FRAMES].any():
            return float(frame)
    return math.inf


def recovery(truth: Truth, track: RecordedTrack, joints: str = "upper") -> float | None:
    """`recovery_frames` after the capture's change of light, or after the end of its occlusion, with a limit of 10 cm to
    the end; None for a capture with neither."""
    since_s = truth.light_change_s if truth.clear_s is None else truth.clear_s
    if since_s is None:
        return None
    errors = frame_errors_m(truth, track, joints)
    after = np.isfinite(truth.times_s) & (truth.times_s >= since_s)
    hid = truth.clear_s is not None
    limit_m = CLEAR_LIMIT_M if hid else LIMIT_M
    return recovery_frames(errors[after & ~np.isnan(errors)], limit_m, for_good=hid)
