"""A recording as if some of its cameras had not been there."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from mocapd.calibration.calibration_record import Calibration
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets
from mocapd.evaluate.capture_eval import Case
from mocapd.types import Camera, FrameSet, Rig


def calibration_of(
    case: Case, stature_m: float, is_used: Callable[[int, Camera], bool]
) -> Calibration:
    """What is known of a recording, with the cameras that are used, by index and camera; stature_m: if it says none [m]."""
    known = from_capture(case.folder).assuming(stature_m)
    assert known.rig is not None  # of a capture
    cameras = tuple(one for i, one in enumerate(known.rig.cameras) if is_used(i, one))
    return replace(known, rig=Rig(cameras))


def frame_sets_for(case: Case, known: Calibration) -> Iterator[FrameSet]:
    """Its frame sets, with the frames of the cameras of `known` alone."""
    assert known.rig is not None  # of a capture
    used = {camera.name for camera in known.rig.cameras}
    for one in frame_sets(case.folder):
        yield replace(one, frames={name: f for name, f in one.frames.items() if name in used})
