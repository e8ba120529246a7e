"""Runs one tracker on every capture."""

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass
from functools import partial

from mocapd.evaluate.capture_eval import BuildTracker, CaptureResult, Case, evaluate
from mocapd.session.tracker_setup import Progress


@dataclass(frozen=True, slots=True, eq=False)
class EvaluationSettings:
    """Settings for all captures. `stature_m`: the default for captures without one; `progress`: gets the task, the steps
    done, and of all."""

    build: BuildTracker
    stature_m: float
    joints: str
    progress: Progress


def _no_frames(_case: Case) -> Container[int]:
    return ()


def run(
    cases: Sequence[Case],
    setting: EvaluationSettings,
    *,
    method: str = "",
    keep_evidence: Callable[[Case], Container[int]] = _no_frames,
) -> list[CaptureResult]:
    """One result per capture. `method`: a label for the progress; `keep_evidence`: the frames of a capture for which the
    evidence is stored."""
    return [
        evaluate(
            case,
            setting.build,
            stature_m=setting.stature_m,
            joints=setting.joints,
            keep_evidence=keep_evidence(case),
            on_frame=partial(
                _report_frames,
                setting.progress,
                f"{case.name}, {method}" if method else case.name,
                case.frames,
            ),
        )
        for case in cases
    ]


def _report_frames(progress: Progress, what: str, frames: int, done: int) -> None:
    progress(what, done, frames)
