"""How far off a pose is that was predicted for the time of display, beside the last pose held until then.

Recorded captures are tracked as the daemon does, smoothing included. Hands only: what moves fastest.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.shape import skeleton_of
from mocapd.capture.capture_folder import frame_sets
from mocapd.clock import nanoseconds, seconds
from mocapd.evaluate.capture_eval import Case
from mocapd.evaluate.score import SKIP_S
from mocapd.evaluate.tables import number, table
from mocapd.evaluate.truth import Truth
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.prediction.pose_predictor import PosePredictor
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.smoothing import Smoother
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.types import Floats

AHEAD_S = (0.0, 0.016, 0.033, 0.05)
HANDS = ("leftHand", "rightHand")


@dataclass(frozen=True, slots=True, eq=False)
class PredictionErrors:
    """By how far ahead the display is [s]: errors [m] of each hand that was seen, of the last pose held and of the one
    predicted for that time."""

    held_m: Mapping[float, Floats]
    predicted_m: Mapping[float, Floats]


def published(case: Case, ready: ReadyTracker, preset: str) -> Iterator[SkeletonFrame]:
    """What a daemon with this preset of smoothing would send while it watches this capture."""
    shape = ready.shape
    smoother = Smoother(preset, skeleton_of(shape))
    for seq, frames in enumerate(frame_sets(case.folder)):
        track = ready.tracker.step(frames, shape)
        if track.shape is not shape:
            shape = track.shape
            smoother.skeleton = skeleton_of(shape)
        body = smoother.step(track.body)
        yield skeleton_frame(
            body,
            smoother.skeleton,
            instance="evaluation",
            seq=seq,
            publish_monotonic_ns=body.t_ns,
            unix_from_monotonic_ns=0,
        )


def prediction_errors(frames: Iterator[SkeletonFrame], truth: Truth) -> PredictionErrors:
    """A client that hears these frames at once and shows each a moment later."""
    predictor = PosePredictor()
    first_s = truth.times_s[truth.visible][0] + SKIP_S
    held: dict[float, list[Floats]] = {ahead_s: [] for ahead_s in AHEAD_S}
    predicted: dict[float, list[Floats]] = {ahead_s: [] for ahead_s in AHEAD_S}
    for frame in frames:
        predictor.take(frame)
        for ahead_s in AHEAD_S:
            shown_ns = frame.capture_unix_ns + nanoseconds(ahead_s)
            there = _true_hands(truth, seconds(shown_ns))
            later = predictor.at(shown_ns)
            if later is None or not later.joints or there is None or seconds(shown_ns) < first_s:
                continue
            held[ahead_s].append(_distances(frame, there))
            predicted[ahead_s].append(_distances(later, there))
    return PredictionErrors(
        {ahead_s: np.concatenate(errors) for ahead_s, errors in held.items()},
        {ahead_s: np.concatenate(errors) for ahead_s, errors in predicted.items()},
    )


def _distances(frame: SkeletonFrame, there: Floats) -> Floats:
    found = np.array([frame.joints[name].p for name in HANDS])
    distances: Floats = np.linalg.norm(found - there, axis=1)
    return distances


def _true_hands(truth: Truth, at_s: float) -> Floats | None:
    """(2,3) between the two frames of the truth around that time; None outside, or while nobody is there."""
    after = int(np.searchsorted(truth.times_s, at_s, side="right"))
    if not 0 < after < len(truth.times_s):
        return None
    before_s, after_s = truth.times_s[after - 1], truth.times_s[after]
    share = (at_s - before_s) / (after_s - before_s)
    columns = [truth.names.index(name) for name in HANDS]
    a, b = truth.joints_m[after - 1, columns], truth.joints_m[after, columns]
    hands: Floats = a + share * (b - a)
    return hands if np.isfinite(hands).all() else None


def prediction_table(
    cases: Sequence[Case], build: Callable[[Case], ReadyTracker], preset: str
) -> str:
    """RMS of the hands [cm] by capture: held → predicted (their ratio). `build` makes the tracker of a capture."""
    found = [
        (case.name, prediction_errors(published(case, build(case), preset), case.truth))
        for case in cases
    ]
    rows = [_row(name, [errors]) for name, errors in found]
    rows.append(_row("all", [errors for _, errors in found]))
    return table(["capture", "0 ms", *(f"{1e3 * ahead_s:.0f} ms" for ahead_s in AHEAD_S[1:])], rows)


def _row(name: str, errors: Sequence[PredictionErrors]) -> list[str]:
    cells = [name]
    for ahead_s in AHEAD_S:
        held, predicted = (
            100.0 * float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
            for parts in (
                [one.held_m[ahead_s] for one in errors],
                [one.predicted_m[ahead_s] for one in errors],
            )
        )
        if ahead_s == 0.0:
            cells.append(number(held, 2))
            continue
        cells.append(f"{number(held, 2)} → {number(predicted, 2)} ({number(predicted / held, 2)})")
    return cells
