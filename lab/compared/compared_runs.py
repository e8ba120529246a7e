"""Every capture with the tracker and with each method that it is measured by."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from lab.compared.compare import FULL, Comparison
from lab.compared.patch_labels import labelled_frames
from lab.compared.roc import Roc, no_roc
from lab.compared.roc_of_capture import roc_of_capture
from mocapd.evaluate.capture_eval import BuildTracker, CaptureResult, Case
from mocapd.evaluate.runs import EvaluationSettings, run


@dataclass(frozen=True, slots=True, eq=False)
class EvaluationResults:
    """Everything that was measured; `comparison` and `rocs` are empty unless methods were compared."""

    tracker: str
    joints: str
    results: Sequence[CaptureResult]
    comparison: Comparison
    rocs: Sequence[tuple[str, Roc]]

    @property
    def roc(self) -> Roc:
        """Of all captures together."""
        return sum((roc for _, roc in self.rocs), no_roc())


def compare(
    cases: Sequence[Case],
    tracker: str,
    rivals: Mapping[str, BuildTracker],
    setting: EvaluationSettings,
) -> EvaluationResults:
    """Every capture with the tracker and each rival by its label, and the classifiers over the labelled frames."""
    comparison = {FULL: run(cases, setting, method=FULL, keep_evidence=labelled_in)}
    for label, build in rivals.items():
        comparison[label] = run(cases, replace(setting, build=build), method=label)
    labelled = [result for result in comparison[FULL] if labelled_in(result.case)]
    rocs = []
    for done, result in enumerate(labelled, start=1):
        rocs.append((result.case.name, roc_of_capture(result, setting.stature_m)))
        setting.progress("classifying labelled frames", done, len(labelled))
    return EvaluationResults(tracker, setting.joints, comparison[FULL], comparison, rocs)


def labelled_in(case: Case) -> set[int]:
    """The frames of which one camera at least has a picture of labels."""
    folder = case.folder
    return {
        frame for camera in folder.cameras for frame in labelled_frames(folder.path, camera.video)
    }
