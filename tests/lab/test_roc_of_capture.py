"""The classifiers over a capture that the simulator exported, with its true poses as the track."""

from pathlib import Path

import numpy as np
import pytest

from lab.compared.patch_labels import labelled_frames, read_label
from lab.compared.roc import correct_at
from lab.compared.roc_of_capture import roc_of_capture
from mocapd.evaluate.capture_eval import CaptureResult, Evidence, open_case
from mocapd.evaluate.recovery import recovery
from mocapd.evaluate.score import score
from mocapd.session.offline import RecordedTrack
from mocapd.shirt.standard_shirt import standard_shirt
from tests.sim.kept_capture import kept_capture
from tests.sim.small import scenario

pytestmark = pytest.mark.kernels

LABELLED = (0, 15, 30)


@pytest.fixture(scope="module")
def perfect(cache_home: Path) -> CaptureResult:
    folder = kept_capture(scenario(person_appears_s=0.2), 1.1, cache_home)
    case = open_case(folder)
    with np.load(folder / "truth.npz") as truth:
        seen = truth["visible"]
        n = int(seen.sum())
        track = RecordedTrack(
            truth["times"][seen],
            case.truth.names,
            truth["joints"][seen].astype(float),
            truth["global_quats"][seen].astype(float),
            np.ones((n, len(case.truth.names))),
            np.array(["truth"] * n),
        )
    evidence = {}
    for frame in LABELLED[1:]:  # a tracker that knows the half of it
        label = standard_shirt().colour_of_patch[read_label(folder, Path("cam0.mp4"), frame)]
        label[::2] = 0
        evidence["left", frame] = Evidence(label, (0, 0, 160, 120))
    figures = score(case.truth, track), recovery(case.truth, track)
    return CaptureResult(case, track, *figures, 1.0, evidence)


def test_the_pose_helps_to_tell_the_colours(perfect: CaptureResult) -> None:
    assert perfect.score.rms_cm == pytest.approx(0.0, abs=1e-3)
    roc = roc_of_capture(perfect, 1.75)
    assert roc.alone.shirt == roc.assisted.shirt > 500
    assert roc.alone.looked_at > 2 * roc.alone.shirt
    assert correct_at(roc.assisted, 0.05) > correct_at(roc.alone, 0.05)
    assert correct_at(roc.assisted, 0.05) > 0.6


def test_what_the_tracker_said_is_counted_where_it_looked(perfect: CaptureResult) -> None:
    tracker = roc_of_capture(perfect, 1.75).tracker
    assert tracker.looked_at == 2 * 160 * 120
    assert tracker.wrong.tolist() == [0.0]
    assert tracker.correct[0] == pytest.approx(0.5, abs=0.05)


def test_labelled_frames_are_those_of_the_video(tmp_path: Path) -> None:
    (tmp_path / "labels").mkdir()
    for name in ("cam0_000030", "cam0_000015", "cam1_000045", "cam0_other"):
        (tmp_path / "labels" / f"{name}.png").touch()
    assert labelled_frames(tmp_path, Path("cam0.mp4")) == (15, 30)
    assert labelled_frames(tmp_path, Path("cam2.mp4")) == ()
