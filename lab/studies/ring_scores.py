"""The whole body before cameras all around, scored in a recording or in what is left of it without one camera."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lab.studies.fewer_cameras import calibration_of, frame_sets_for
from mocapd.evaluate.capture_eval import BuildTracker, Case
from mocapd.evaluate.score import match, score
from mocapd.evaluate.truth import Truth
from mocapd.session.offline import RecordedTrack, track_all
from mocapd.types import Floats

_LEG = ("UpperLeg", "LowerLeg", "Foot")
_EXCHANGED_M = (
    0.1  # by which legs must be nearer to each other's true places, on average over their joints
)


@dataclass(frozen=True, slots=True)
class RingScore:
    """Of the whole body in one recording. left_out: the camera whose frames the tracker did not get, or nothing;
    exchanged: share of the tracked frames with left and right leg exchanged."""

    name: str
    cameras: int
    left_out: str
    coverage: float
    rms_cm: float
    median_cm: float
    angle_deg: float
    jitter_ratio: float
    step_p99_cm: float
    exchanged: float


def ring_score(case: Case, left_out: str, build: BuildTracker, stature_m: float) -> RingScore:
    """Track a capture without one camera, or with all (""), and score the whole body."""
    known = calibration_of(case, stature_m, lambda _, camera: camera.name != left_out)
    assert known.rig is not None  # of a capture
    ready = build(known)
    track = track_all(ready.tracker, ready.shape, frame_sets_for(case, known), _nothing)
    of = score(case.truth, track, "full")
    return RingScore(
        case.name, len(known.rig.cameras), left_out, of.coverage, of.rms_cm, of.median_cm, of.joint_angle_deg,
        of.jitter_ratio, of.step_error_p99_cm, exchanged_share(case.truth, track),
    )  # fmt: skip


def _nothing(done: int) -> None:
    """No progress within a recording."""


def exchanged_share(truth: Truth, track: RecordedTrack) -> float:
    """Share of the tracked frames in which the legs are nearer to each other's true places; NaN without any."""
    matches = match(truth, track, "full")
    if not len(matches.track_rows):
        return float("nan")

    def legs(names: Sequence[str], joints_m: Floats, sides: tuple[str, str]) -> Floats:
        return joints_m[:, [list(names).index(side + bone) for side in sides for bone in _LEG]]

    found = legs(track.joint_names, track.joints_m[matches.track_rows], ("left", "right"))
    true_m = truth.joints_m[matches.truth_rows]

    def error_m(sides: tuple[str, str]) -> Floats:
        apart_m = np.linalg.norm(found - legs(truth.names, true_m, sides), axis=2)
        return np.asarray(apart_m.mean(axis=1))

    nearer_m = error_m(("left", "right")) - error_m(("right", "left"))
    return float((nearer_m > _EXCHANGED_M).mean())
