"""Tracks every frame of one capture, and scores the track."""

import time
from collections.abc import Callable, Container
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.body.shape import BodyShape
from mocapd.calibration.calibration_record import Calibration
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import CaptureFolder, frame_sets, load_folder
from mocapd.capture.kinds.folder_kind import FolderOrigin
from mocapd.evaluate.recovery import recovery
from mocapd.evaluate.score import Score, score
from mocapd.evaluate.truth import Truth, load_truth
from mocapd.session.capture_checks import CheckedCapture, check_capture
from mocapd.session.offline import RecordedTrack, track_all
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.tracking.base import Probe, Track, Tracker, no_probe
from mocapd.types import BodyState, Bytes, FrameSet

BuildTracker = Callable[[Calibration], ReadyTracker]


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """A tracker's colour classification of one frame: ids (h,w) over roi_px = x0, y0, x1, y1."""

    ids: Bytes
    roi_px: tuple[int, int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A capture with its ground truth. checked: the check of rig and times against the pictures, if it was done."""

    folder: CaptureFolder
    truth: Truth
    checked: CheckedCapture | None = None

    @property
    def name(self) -> str:
        return self.folder.path.name

    @property
    def frames(self) -> int:
        return max(camera.frames for camera in self.folder.cameras)


@dataclass(frozen=True, slots=True, eq=False)
class CaptureResult:
    """One tracker on one capture. recovery_frames: None when the light is steady, infinite for never;
    step_ms: median time of a frame set in the tracker alone; evidence: by (camera, frame), as asked."""

    case: Case
    track: RecordedTrack
    score: Score
    recovery_frames: float | None
    step_ms: float
    evidence: dict[tuple[str, int], Evidence]


class _TimedTracker:
    """A tracker with a stopwatch that stores its evidence of the requested frames."""

    def __init__(self, tracker: Tracker, keep: Container[int]) -> None:
        self.name = tracker.name
        self.probe: Probe = no_probe
        self._tracker, self._keep = tracker, keep
        self.step_ms: list[float] = []
        self.evidence: dict[tuple[str, int], Evidence] = {}

    def reset(self, near: BodyState | None = None) -> None:
        self._tracker.reset(near)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        start_s = time.perf_counter()
        track = self._tracker.step(frames, shape)
        self.step_ms.append(1e3 * (time.perf_counter() - start_s))
        for camera, ids in track.evidence.items():
            frame = frames.frames[camera].seq
            if frame in self._keep:
                # the array may be a buffer of the tracker's
                self.evidence[camera, frame] = Evidence(ids.copy(), track.roi_px[camera])
        return track


def open_case(capture: Path, compare: bool = False) -> Case:
    """Read a capture and its truth; `compare`: also check its rig and times against the pictures. Raises InputError or
    ConfigError naming the file."""
    folder, truth = load_folder(capture), load_truth(capture)
    return Case(folder, truth, check_capture(FolderOrigin(folder)) if compare else None)


def evaluate(
    case: Case,
    build: BuildTracker,
    *,
    stature_m: float,
    joints: str = "upper",
    keep_evidence: Container[int] = (),
    on_frame: Callable[[int], None] = lambda _: None,
) -> CaptureResult:
    """Track a capture from its first frame to its last, and score it.

    `stature_m` is the default for captures without one. The tracker gets the same input as in
    `mocapd track`: the rig, the videos, the stature and the user's strokes, never the truth.
    """
    ready = build(from_capture(case.folder).assuming(stature_m))
    watched = _TimedTracker(ready.tracker, keep_evidence)
    checked = case.checked
    frames = checked.frame_sets() if checked else frame_sets(case.folder)
    off_m = checked.result.off_m if checked else 0.0
    track = track_all(watched, ready.shape, frames, on_frame, off_m)
    return CaptureResult(
        case=case,
        track=track,
        score=score(case.truth, track, joints),
        recovery_frames=recovery(case.truth, track, joints),
        step_ms=float(np.median(watched.step_ms)) if watched.step_ms else float("nan"),
        evidence=watched.evidence,
    )
