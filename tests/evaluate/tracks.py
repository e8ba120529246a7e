"""A ground truth made of a moving arm, and tracks that differ from it as a test asks."""

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, N_JOINTS, standard_skeleton
from mocapd.evaluate.truth import Truth
from mocapd.session.offline import RecordedTrack
from mocapd.types import Floats

EMPTY, FRAMES = 10, 70  # frames before the person comes, and in all


def moving_truth(light_change_s: float | None = None, clear_s: float | None = None) -> Truth:
    """A person who comes in frame 10, sways, and waves its left hand."""
    times_s = np.arange(FRAMES) / 30.0
    joints = np.tile(standard_skeleton(1.7).rest_m, (FRAMES, 1, 1))
    joints[..., 2] += 0.1 * np.sin(5.0 * times_s)[:, None]
    joints[:, INDEX["leftHand"], 1] += 0.2 * np.sin(9.0 * times_s)
    joints[:, INDEX["leftLowerArm"], 2] += 0.1 * np.cos(7.0 * times_s)
    joints[:EMPTY] = np.nan
    return Truth(NAMES, times_s, joints, np.arange(FRAMES) >= EMPTY, light_change_s, clear_s)


def track_of(
    truth: Truth, error_m: Floats | float = 0.0, keep: slice | list[int] = slice(EMPTY, None)
) -> RecordedTrack:
    """The truth in the frames of `keep`, every joint moved to its left by error_m, () or (F,) or (F,J)."""
    error = np.asarray(error_m, dtype=float)
    error = error.reshape(error.shape + (1,) * (2 - error.ndim))
    joints = truth.joints_m.copy()
    joints[..., 0] += np.broadcast_to(error, joints.shape[:2])
    kept = joints[keep]
    n = len(kept)
    return RecordedTrack(
        truth.times_s[keep],
        NAMES,
        kept,
        np.tile([0.0, 0.0, 0.0, 1.0], (n, N_JOINTS, 1)),
        np.ones((n, N_JOINTS)),
        np.array(["test"] * n, dtype=np.str_),
    )
