"""Whole evaluations: every capture with one method, or with all of them side by side."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

from mocapd.evaluate.capture_eval import BuildTracker, CaptureResult, Case, evaluate
from mocapd.evaluate.compare import FULL, Comparison
from mocapd.evaluate.roc import Roc, no_roc
from mocapd.evaluate.truth import labelled_frames
from mocapd.session.tracker_setup import Progress


@dataclass(frozen=True, slots=True, eq=False)
class EvaluationSettings:
    """What holds for every capture. `stature_m` is for those that do not say; `progress` is told what
    is being done, how far, and how far it goes."""

    build: BuildTracker
    stature_m: float
    joints: str
    progress: Progress


@dataclass(frozen=True, slots=True, eq=False)
class EvaluationResults:
    """Everything that was measured; `comparison` and `rocs` are empty unless it was compared."""

    tracker: str
    joints: str
    results: Sequence[CaptureResult]
    comparison: Comparison
    rocs: Sequence[tuple[str, Roc]]

    @property
    def roc(self) -> Roc:
        """Of all captures together."""
        return sum((roc for _, roc in self.rocs), no_roc())


def run(cases: Sequence[Case], method: str, setting: EvaluationSettings) -> list[CaptureResult]:
    """Every capture with one of the methods."""
    return [
        evaluate(
            case,
            setting.build,
            stature_m=setting.stature_m,
            method=method,
            joints=setting.joints,
            keep_evidence=_labelled(case),
            on_frame=partial(_frames_done, setting.progress, f"{case.name}, {method}", case.frames),
        )
        for case in cases
    ]


def compare(
    cases: Sequence[Case], tracker: str, rivals: Iterable[str], setting: EvaluationSettings
) -> EvaluationResults:
    """Every capture with the tracker and each of its rivals, and the classifiers over the labelled frames."""
    # the colour tracker is a second to import, and needed only here
    from mocapd.evaluate.roc_of_capture import roc_of_capture

    comparison = {method: run(cases, method, setting) for method in (FULL, *rivals)}
    labelled = [result for result in comparison[FULL] if _labelled(result.case)]
    rocs = []
    for done, result in enumerate(labelled, start=1):
        rocs.append((result.case.name, roc_of_capture(result, setting.stature_m)))
        setting.progress("classifying labelled frames", done, len(labelled))
    return EvaluationResults(tracker, setting.joints, comparison[FULL], comparison, rocs)


def _labelled(case: Case) -> set[int]:
    folder = case.folder
    return {
        frame for camera in folder.cameras for frame in labelled_frames(folder.path, camera.video)
    }


def _frames_done(progress: Progress, what: str, frames: int, done: int) -> None:
    progress(what, done, frames)
