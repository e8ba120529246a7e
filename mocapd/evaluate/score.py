"""A track against the ground truth: coverage, ghosts, joint errors, angles, jitter.

Nothing is aligned, scaled or smoothed first: the world frame of a capture is absolute, in metres.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mocapd.errors import InputError
from mocapd.evaluate.truth import Truth
from mocapd.session.offline import RecordedTrack
from mocapd.types import Floats, Ints

_UPPER = (
    "hips", "neck", "leftUpperArm", "leftLowerArm", "leftHand",
    "rightUpperArm", "rightLowerArm", "rightHand",
)  # fmt: skip
_LEGS = (
    "leftUpperLeg", "leftLowerLeg", "leftFoot", "rightUpperLeg", "rightLowerLeg", "rightFoot",
)  # fmt: skip
JOINT_SETS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"upper": _UPPER, "arms": _UPPER[2:], "legs": _LEGS, "full": (*_UPPER, "head", *_LEGS)}
)

# (parent, joint, child): the interior angle at `joint`
Angle = tuple[str, str, str]
_UPPER_ANGLES: tuple[Angle, ...] = (
    ("hips", "neck", "leftUpperArm"),
    ("neck", "leftUpperArm", "leftLowerArm"),
    ("leftUpperArm", "leftLowerArm", "leftHand"),
    ("neck", "rightUpperArm", "rightLowerArm"),
    ("rightUpperArm", "rightLowerArm", "rightHand"),
)
_LEG_ANGLES: tuple[Angle, ...] = (
    ("neck", "leftUpperLeg", "leftLowerLeg"),
    ("leftUpperLeg", "leftLowerLeg", "leftFoot"),
    ("neck", "rightUpperLeg", "rightLowerLeg"),
    ("rightUpperLeg", "rightLowerLeg", "rightFoot"),
)
ANGLE_SETS: Mapping[str, tuple[Angle, ...]] = MappingProxyType(
    {
        "upper": _UPPER_ANGLES,
        "arms": _UPPER_ANGLES[1:],
        "legs": _LEG_ANGLES,
        "full": _UPPER_ANGLES + _LEG_ANGLES,
    }
)

CONFIDENT = 0.4  # least confidence of a reliable joint
SKIP_S = 0.5  # ignored after the person first appears
TOLERANCE_S = 1 / 60  # largest time difference of a match
_GHOST_TOLERANCE_S = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Matches:
    """The frames to score, rows (N,) of the truth; for the K tracked ones the rows in the truth and in the track."""

    rows: Ints
    truth_rows: Ints
    track_rows: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Score:
    """Errors are NaN where nothing was tracked; `per_joint_rms_cm` by joint name.

    coverage: share of the frames with the person that were tracked; ghost_frames: tracked frames
    before the person came; jitter: median second difference of the joints from frame to frame,
    absolute and as a ratio to that of the truth; step_error: a joint's motion from frame to frame in excess of its true
    motion; confident, doubtful: share and errors of the joints of confidence CONFIDENT or more, and of the others.
    """

    frames: int
    coverage: float
    ghost_frames: int
    rms_cm: float
    median_cm: float
    p95_cm: float
    per_joint_rms_cm: Mapping[str, float]
    joint_angle_deg: float
    jitter_ratio: float
    jitter_mm: float
    step_error_p99_cm: float
    step_error_max_cm: float
    confident_share: float
    confident_rms_cm: float
    doubtful_rms_cm: float


def match(truth: Truth, track: RecordedTrack, joints: str = "upper") -> Matches:
    """Pair the frames of truth and track by time. Raises InputError when the track lacks joints."""
    wanted = _columns(track.joint_names, joints, "the track")
    first_s = truth.times_s[truth.visible][0]
    rows = np.flatnonzero(truth.visible & (truth.times_s >= first_s + SKIP_S))
    good = np.flatnonzero(np.isfinite(track.joints_m[:, wanted]).all(axis=(1, 2)))
    if not len(good):
        return Matches(rows, rows[:0], good)
    apart_s = np.abs(track.times_s[good][None, :] - truth.times_s[rows][:, None])
    nearest = apart_s.argmin(axis=1)
    found = apart_s[np.arange(len(rows)), nearest] <= TOLERANCE_S
    return Matches(rows, rows[found], good[nearest[found]])


def joint_errors_m(
    truth: Truth, track: RecordedTrack, matches: Matches, joints: str = "upper"
) -> Floats:
    """Distances (K,J) [m] of the joints in the matched frames."""
    a, b = _matching_joints(truth, track, matches, joints)
    errors: Floats = np.linalg.norm(a - b, axis=2)
    return errors


def score(truth: Truth, track: RecordedTrack, joints: str = "upper") -> Score:
    """Score the joints of a set of JOINT_SETS. Raises InputError when the track lacks one."""
    matches = match(truth, track, joints)
    a, b = _matching_joints(truth, track, matches, joints)
    error_cm = 100.0 * np.linalg.norm(a - b, axis=2)
    tracked = len(matches.truth_rows) > 0
    nan = float("nan")
    jitter_mm = true_jitter_mm = nan
    steps_cm = np.array([nan])
    if len(matches.truth_rows) > 3:
        jitter_mm, true_jitter_mm = 1000.0 * _jitter(b), 1000.0 * _jitter(a)
        steps_cm = 100.0 * np.linalg.norm(np.diff(b - a, axis=0), axis=2)
    columns = _columns(track.joint_names, joints, "the track")
    sure = track.confidence[matches.track_rows][:, columns] >= CONFIDENT
    return Score(
        frames=len(matches.rows),
        coverage=len(matches.truth_rows) / max(len(matches.rows), 1),
        ghost_frames=_ghosts(truth, track, joints),
        rms_cm=_rms(error_cm) if tracked else nan,
        median_cm=float(np.median(error_cm)) if tracked else nan,
        p95_cm=float(np.percentile(error_cm, 95)) if tracked else nan,
        per_joint_rms_cm={
            name: _rms(error_cm[:, i]) if tracked else nan
            for i, name in enumerate(JOINT_SETS[joints])
        },
        joint_angle_deg=_angle_error_deg(truth, track, matches, joints) if tracked else nan,
        jitter_ratio=jitter_mm / max(true_jitter_mm, 1e-3),
        jitter_mm=jitter_mm,
        step_error_p99_cm=float(np.percentile(steps_cm, 99)),
        step_error_max_cm=float(steps_cm.max()),
        confident_share=float(sure.mean()) if tracked else nan,
        confident_rms_cm=_rms(error_cm[sure]) if sure.any() else nan,
        doubtful_rms_cm=_rms(error_cm[~sure]) if not sure.all() else nan,
    )


def interior_angle_deg(joints_m: Floats, names: Sequence[str], angle: Angle) -> Floats:
    """The angle (F,) [degrees] at the middle one of three joints of joints_m (F,J,3)."""
    a, b, c = (joints_m[:, list(names).index(name)] for name in angle)
    u, v = a - b, c - b
    u = u / np.linalg.norm(u, axis=-1, keepdims=True)
    v = v / np.linalg.norm(v, axis=-1, keepdims=True)
    degrees: Floats = np.degrees(np.arccos(np.clip(np.sum(u * v, axis=-1), -1.0, 1.0)))
    return degrees


def _columns(names: Sequence[str], joints: str, source: str) -> list[int]:
    missing = [name for name in JOINT_SETS[joints] if name not in names]
    if missing:
        raise InputError(
            f"{source} lacks the joints {', '.join(missing)}", fix="score other joints"
        )
    return [list(names).index(name) for name in JOINT_SETS[joints]]


def _matching_joints(
    truth: Truth, track: RecordedTrack, matches: Matches, joints: str
) -> tuple[Floats, Floats]:
    """Joints (K,J,3) of truth and track in the matched frames."""
    true = truth.joints_m[matches.truth_rows][:, _columns(truth.names, joints, "the truth")]
    tracked = track.joints_m[matches.track_rows][:, _columns(track.joint_names, joints, "track")]
    return true, tracked


def _ghosts(truth: Truth, track: RecordedTrack, joints: str) -> int:
    wanted = _columns(track.joint_names, joints, "the track")
    times_s = track.times_s[np.isfinite(track.joints_m[:, wanted]).all(axis=(1, 2))]
    empty_s = truth.times_s[~truth.visible & (truth.times_s < truth.times_s[truth.visible][0])]
    apart_s = np.abs(times_s[None, :] - empty_s[:, None])
    ghost: NDArray[np.bool_] = (apart_s < _GHOST_TOLERANCE_S).any(axis=1)
    return int(ghost.sum())


def _angle_error_deg(truth: Truth, track: RecordedTrack, matches: Matches, joints: str) -> float:
    # from the whole body: the angles of arms and legs need the neck, which is in neither set
    true, tracked = truth.joints_m[matches.truth_rows], track.joints_m[matches.track_rows]
    errors = [
        interior_angle_deg(true, truth.names, angle)
        - interior_angle_deg(tracked, track.joint_names, angle)
        for angle in ANGLE_SETS[joints]
    ]
    return float(np.nanmean(np.abs(errors)))


def _jitter(joints_m: Floats) -> float:
    second = joints_m[2:] - 2.0 * joints_m[1:-1] + joints_m[:-2]
    return float(np.median(np.linalg.norm(second, axis=2)))


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))
