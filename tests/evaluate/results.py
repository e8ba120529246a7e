"""Results without a tracker: a capture of n cameras that exists in name only, and a track of it."""

from pathlib import Path

from mocapd.capture.capture_folder import CaptureFolder, RecordedCamera
from mocapd.evaluate.capture_eval import CaptureResult, Case
from mocapd.evaluate.recovery import recovery
from mocapd.evaluate.score import score
from mocapd.types import Floats, Rig
from tests.evaluate.tracks import EMPTY, FRAMES, moving_truth, track_of


def result_of(
    name: str,
    error_m: Floats | float,
    cameras: int = 2,
    light_change_s: float | None = None,
    keep: slice | list[int] = slice(EMPTY, None),
) -> CaptureResult:
    """As if a tracker had been off by error_m in every frame."""
    truth = moving_truth(light_change_s)
    recorded = tuple(
        RecordedCamera(f"cam{i}", Path(f"cam{i}.mp4"), (640, 480), 30.0, 0.0, FRAMES, None)
        for i in range(cameras)
    )
    track = track_of(truth, error_m, keep)
    return CaptureResult(
        Case(CaptureFolder(Path("captures") / name, Rig(()), recorded, 1.7, ()), truth),
        track,
        score(truth, track),
        recovery(truth, track),
        5.25,
        {},
    )
