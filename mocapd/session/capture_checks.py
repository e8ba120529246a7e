"""Checks a recording's rig and times against what it shows, before it is tracked, and corrects what surely is wrong."""

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
_LONGEST_S = 60.0  # of a recording, that is looked at until enough has moved


@dataclass(frozen=True, slots=True, eq=False)
class CheckedCapture:
    """A recording, and what its checks found."""

    origin: Origin
    result: CheckResult

    def frame_sets(self) -> Iterator[FrameSet]:
        """All of it once, with the times of cameras that were surely late corrected."""
        late_s = self.result.late_s
        sets = self.origin.frame_sets()
        if not late_s:
            return sets
        return delayed_sets(sets, self.origin.rig.names, late_s, self.origin.fps_hz)


def check_capture(
    origin: Origin, rig: Rig | None = None, stature_m: float | None = None
) -> CheckedCapture:
    """Look at the beginning of a recording; says in the log what does not agree. rig: where it is not the recording's own."""
    check = CaptureCheck(rig or origin.rig, stature_m or origin.stature_m)
    for number, frames in enumerate(origin.frame_sets()):
        for frame in frames.frames.values():
            check.put(frame)
        if number % 30 == 29 and (check.has_enough or seconds(frames.t_ns) > _LONGEST_S):
            break
    result = check.result()
    if result.looked < _LEAST_LOOKED and len(check.names) > 1:
        _log.info(
            "%s: too little of a person is seen by two cameras at once to compare the rig with what it shows",
            origin.rig_source,
        )
    for finding in result.findings:
        _log.warning("%s: %s", origin.rig_source, finding)
    return CheckedCapture(origin, result)
