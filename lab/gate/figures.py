"""The figures of one track of one recording."""

import math
from dataclasses import asdict, dataclass, fields

import numpy as np

from mocapd.evaluate.reliability import NEAR_CM
from mocapd.evaluate.score import JOINT_SETS, match, score
from mocapd.evaluate.truth import Truth
from mocapd.session.offline import RecordedTrack
from mocapd.types import Floats

STILL_S = 10.0
TREMBLE_HZ = 2.0  # faster motion of somebody who stands still is trembling
_SURE = 0.8  # confidence
_TOES = ("leftToes", "rightToes")
_ENDS = ("leftHand", "rightHand", "head", "leftFoot", "rightFoot")
_FEET = ("leftFoot", "rightFoot")


@dataclass(frozen=True, slots=True)
class Figures:
    """NaN where a figure does not apply. All but coverage and sure_near are the better the smaller.

    rms_cm, median_cm, p95_cm: errors of the scored joints; step_p99_cm: motion from frame to frame beyond the true one;
    jitter_mm: median second difference; acceleration_mm: mean error of the acceleration [mm/frame^2]; toes_cm: RMS;
    sure_near: share within 5 cm of joints of confidence 0.8 and more; recovery_frames: after a change of light, or when the
    person is in the open again; tremble_mm, drift_mm: of somebody who stands still, RMS above 2 Hz of hands, head and
    feet, and how far a foot goes; step_ms: median of a frame set; cpu_ms: processor time of a frame set.
    """

    rms_cm: float = math.nan
    median_cm: float = math.nan
    p95_cm: float = math.nan
    step_p99_cm: float = math.nan
    jitter_mm: float = math.nan
    acceleration_mm: float = math.nan
    toes_cm: float = math.nan
    coverage: float = math.nan
    ghosts: float = math.nan
    sure_near: float = math.nan
    recovery_frames: float = math.nan
    tremble_mm: float = math.nan
    drift_mm: float = math.nan
    step_ms: float = math.nan
    cpu_ms: float = math.nan


NAMES = tuple(field.name for field in fields(Figures))
BETTER_HIGH = frozenset({"coverage", "sure_near"})


def as_row(figures: Figures) -> dict[str, float]:
    """By name, without those that do not apply."""
    return {name: value for name, value in asdict(figures).items() if not math.isnan(value)}


def track_figures(truth: Truth, track: RecordedTrack, joints: str) -> Figures:
    """Of the joints of a set of JOINT_SETS; without times. Raises InputError when the track lacks a joint."""
    of = score(truth, track, joints)
    matches = match(truth, track, joints)
    columns = [track.joint_names.index(name) for name in JOINT_SETS[joints]]
    true_columns = [truth.names.index(name) for name in JOINT_SETS[joints]]
    tracked = track.joints_m[matches.track_rows]
    true = truth.joints_m[matches.truth_rows]
    error_cm = 100.0 * np.linalg.norm(tracked[:, columns] - true[:, true_columns], axis=2)
    sure = track.confidence[matches.track_rows][:, columns] >= _SURE
    return Figures(
        rms_cm=of.rms_cm,
        median_cm=of.median_cm,
        p95_cm=of.p95_cm,
        step_p99_cm=of.step_error_p99_cm,
        jitter_mm=of.jitter_mm,
        acceleration_mm=acceleration_error_mm(
            tracked[:, columns] - true[:, true_columns], matches.track_rows
        ),
        toes_cm=_toes_cm(truth, track, true, tracked) if joints == "full" else math.nan,
        coverage=of.coverage,
        ghosts=float(of.ghost_frames),
        sure_near=float((error_cm[sure] <= NEAR_CM).mean()) if sure.any() else math.nan,
    )


def acceleration_error_mm(apart_m: Floats, rows: np.ndarray) -> float:
    """Mean length of the second difference [mm/frame^2] of the error vectors apart_m (K,J,3), of three frames that follow
    each other by their indices `rows` (K,)."""
    if len(rows) < 3:
        return math.nan
    second_m = apart_m[2:] - 2.0 * apart_m[1:-1] + apart_m[:-2]
    following = rows[2:] - rows[:-2] == 2
    if not following.any():
        return math.nan
    return float(1000.0 * np.linalg.norm(second_m[following], axis=2).mean())


def rest_figures(track: RecordedTrack, from_s: float) -> Figures:
    """Of somebody who stands still for STILL_S from `from_s` [s] of a recording at one rate."""
    rows = np.flatnonzero((track.times_s >= from_s) & (track.times_s < from_s + STILL_S))
    if len(rows) < 10:
        return Figures()
    times_s = track.times_s[rows]
    ends = [track.joint_names.index(name) for name in _ENDS]
    feet = [track.joint_names.index(name) for name in _FEET]
    rate_hz = 1.0 / float(np.median(np.diff(times_s)))
    swift_m = above(track.joints_m[rows][:, ends], rate_hz, TREMBLE_HZ)
    places_m = track.joints_m[rows][:, feet]
    away_m = np.linalg.norm(places_m - np.median(places_m, axis=0), axis=2)
    return Figures(
        tremble_mm=1000.0 * float(np.sqrt((swift_m**2).sum(axis=2).mean())),
        drift_mm=1000.0 * float(np.percentile(away_m, 95)),
    )


def above(signal: Floats, rate_hz: float, limit_hz: float) -> Floats:
    """What of a signal (F,...) at a rate is faster than a limit; a straight trend counts as slow."""
    frames = len(signal)
    line = np.linspace(0.0, 1.0, frames).reshape(-1, *[1] * (signal.ndim - 1))
    level = signal - (signal[:1] + (signal[-1:] - signal[:1]) * line)
    spectrum = np.fft.rfft(level, axis=0)
    spectrum[np.fft.rfftfreq(frames, 1.0 / rate_hz) < limit_hz] = 0.0
    swift: Floats = np.fft.irfft(spectrum, frames, axis=0)
    return swift


def _toes_cm(truth: Truth, track: RecordedTrack, true: Floats, tracked: Floats) -> float:
    if not set(_TOES) <= set(truth.names) & set(track.joint_names) or not len(true):
        return math.nan
    a = true[:, [truth.names.index(name) for name in _TOES]]
    b = tracked[:, [track.joint_names.index(name) for name in _TOES]]
    return float(100.0 * np.sqrt(((a - b) ** 2).sum(axis=2).mean()))
