"""Checks rig and times of a recording against its pictures before tracking; corrects significant time offsets."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass

from mocapd.calibrate.consistency.capture_check import CaptureCheck, CheckResult
from mocapd.capture.frame_groups import delayed_sets
from mocapd.capture.origin import Origin
from mocapd.clock import seconds
from mocapd.types import FrameSet, Rig

_log = logging.getLogger(__name__)

_LEAST_LOOKED = 2  # views of two cameras
_LONGEST_S = 60.0  # longest part of a recording that is checked


@dataclass(frozen=True, slots=True, eq=False)
class CheckedCapture:
    """A recording and the result of its checks."""

    origin: Origin
    result: CheckResult

    def frame_sets(self) -> Iterator[FrameSet]:
        """All frame sets once, with significant camera delays corrected."""
        late_s = self.result.late_s
        sets = self.origin.frame_sets()
        if not late_s:
            return sets
        return delayed_sets(sets, self.origin.rig.names, late_s, self.origin.fps_hz)


def check_capture(
    origin: Origin, rig: Rig | None = None, stature_m: float | None = None
) -> CheckedCapture:
    """Checks the beginning of a recording and logs contradictions. rig: overrides the recording's own."""
    check = CaptureCheck(rig or origin.rig, stature_m or origin.stature_m)
    for number, frames in enumerate(origin.frame_sets()):
        for frame in frames.frames.values():
            check.put(frame)
        if number % 30 == 29 and (check.has_enough or seconds(frames.t_ns) > _LONGEST_S):
            break
    result = check.result()
    if result.looked < _LEAST_LOOKED and len(check.names) > 1:
        _log.info(
            "%s: two cameras show too little of a person at once to compare the rig with the pictures",
            origin.rig_source,
        )
    for finding in result.findings:
        _log.warning("%s: %s", origin.rig_source, finding)
    return CheckedCapture(origin, result)
