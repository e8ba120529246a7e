"""The gate: what is noise and what is not, and figures of motions whose answer is known."""

from pathlib import Path

import numpy as np
import pytest

from lab.gate.figures import above, acceleration_error_mm
from lab.gate.gate_file import SCHEMA, GateFile, GateRow, read_gate, write_gate
from lab.gate.measuring import measure
from lab.gate.report import report
from lab.gate.sets import cases_of
from lab.gate.verdict import failures, row_changes, set_changes
from mocapd.body.shape import BodyShape, mean_shape
from mocapd.errors import InputError
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track
from mocapd.types import FrameSet
from tests.cli.small_capture import write_capture, write_video
from tests.evaluate.tracks import moving_truth


def file_of(commit: str, loop_ms: float = 10.0, **runs: list[float]) -> GateFile:
    row = GateRow(set_name="dev", name="one", joints="full", runs=runs)
    return GateFile(
        schema=SCHEMA, commit=commit, tracker="auto", python="3.11", loop_ms=loop_ms, rows=[row]
    )


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ([6.0, 6.4, 5.8], [6.3, 6.1, 6.6], "noise"),
        ([6.0, 6.1, 5.9], [7.0, 7.1, 6.9], "worse"),
        ([7.0, 7.1, 6.9], [6.0, 6.1, 5.9], "better"),
        ([6.0], [6.2], "noise"),  # one run each tells little
    ],
)
def test_a_difference_that_runs_of_one_commit_have_too_is_noise(
    old: list[float], new: list[float], word: str
) -> None:
    (change,) = row_changes(file_of("a", rms_cm=old), file_of("b", rms_cm=new))
    assert change.word == word
    assert bool(failures(file_of("a", rms_cm=old), file_of("b", rms_cm=new))) is (word == "worse")


def test_more_coverage_is_better_and_a_ghost_never_passes() -> None:
    old, new = (
        file_of("a", coverage=[0.9], ghosts=[0.0]),
        file_of("b", coverage=[1.0], ghosts=[2.0]),
    )
    assert {one.figure: one.word for one in set_changes(old, new)} == {
        "coverage": "better",
        "ghosts": "worse",
    }
    assert any("ghosts" in line for line in failures(old, new))


def test_times_are_scaled_by_the_machines_speed_and_never_fail() -> None:
    old, new = file_of("a", 10.0, step_ms=[8.0, 8.2]), file_of("b", 20.0, step_ms=[16.0, 16.4])
    (change,) = row_changes(old, new)
    assert change.new == pytest.approx(8.1)
    assert change.word == "noise"
    assert failures(old, file_of("b", step_ms=[80.0, 80.0])) == []


def test_a_recording_that_is_gone_does_not_pass(tmp_path: Path) -> None:
    old = file_of("a", rms_cm=[6.0])
    other = GateRow(set_name="dev", name="other", joints="full", runs={"rms_cm": [1.0]})
    new = GateFile(
        schema=SCHEMA, commit="b", tracker="auto", python="3.11", loop_ms=1.0, rows=[other]
    )
    assert "dev/one: not measured" in failures(old, new)
    write_gate(tmp_path / "gate.json", old)
    assert read_gate(tmp_path / "gate.json") == old
    assert "does not pass" in report(old, new).lower()
    (tmp_path / "gate.json").write_text("{}")
    with pytest.raises(InputError):
        read_gate(tmp_path / "gate.json")


def test_trembling_is_what_is_fast_and_a_drift_is_not() -> None:
    t_s = np.arange(300) / 30.0
    slow, fast = (
        0.02 * t_s + 0.01 * np.sin(2 * np.pi * 0.5 * t_s),
        0.003 * np.sin(2 * np.pi * 5 * t_s),
    )
    found = above((slow + fast)[:, None], 30.0, 2.0)[:, 0]
    assert np.sqrt((found**2).mean()) == pytest.approx(0.003 / np.sqrt(2), rel=0.05)


def test_acceleration_is_compared_only_over_frames_that_follow_each_other() -> None:
    apart_m = np.zeros((5, 1, 3))
    apart_m[:, 0, 0] = [0.0, 0.001, 0.0, 9.0, 9.0]  # a jump where frames are missing
    rows = np.array([0, 1, 2, 10, 11])
    assert acceleration_error_mm(apart_m, rows) == pytest.approx(2.0)


class Watched(CannedTracker):
    """Keeps the times of what it was shown."""

    def __init__(self) -> None:
        super().__init__()
        self.times_ns: list[int] = []

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self.times_ns.append(frames.t_ns)
        return super().step(frames, shape)


@pytest.mark.kernels
def test_at_half_rate_every_second_picture_is_shown_and_only_these_are_scored(
    tmp_path: Path,
) -> None:
    folder, truth = write_capture(tmp_path / "one"), moving_truth()
    for name in ("cam0", "cam1"):
        write_video(folder / f"{name}.mp4", frames=len(truth.times_s))
    np.savez(
        folder / "truth.npz",
        times=truth.times_s, names=np.array(truth.names), joints=truth.joints_m, visible=truth.visible,
    )  # fmt: skip
    shown, coverage = {}, {}
    for one in cases_of(("dev", "half_rate"), tmp_path, tmp_path, tmp_path, lambda *_: None):
        tracker = Watched()
        ready = ReadyTracker(tracker, mean_shape(1.7))
        row = measure(one, lambda _, ready=ready: ready, 1, 1.7, lambda _: None)  # type: ignore[misc]
        assert (row.set_name, row.name) == (one.set_name, "one")
        shown[one.set_name], coverage[one.set_name] = tracker.times_ns, row.runs["coverage"]
    assert len(shown["dev"]) == len(truth.times_s)
    assert shown["half_rate"] == shown["dev"][::2]
    assert coverage == {"dev": [1.0], "half_rate": [1.0]}
