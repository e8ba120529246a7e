"""The state of a service in one word: whether it tracks, or why not."""

from typing import Literal

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.service.service import Snapshot
from mocapd.types import Tracking

Readiness = Literal["tracking", "nobody", "slow", "starting", "blind"]

READINESS_STATES: tuple[Readiness, ...] = ("tracking", "nobody", "slow", "starting", "blind")


def readiness_of(snapshot: Snapshot) -> Readiness:
    """tracking: a person is tracked; nobody: cameras deliver, no person in view; slow: too many frame sets are skipped
    for either; starting: no body published yet; blind: no camera delivers."""
    cameras = snapshot.cameras.values()
    if any(delivers(status) for status in cameras):
        if snapshot.metrics.slowness is not None:
            return "slow"
        if snapshot.metrics.tracking is not Tracking.LOST:
            return "tracking"
        return "nobody" if snapshot.metrics.published else "starting"
    opening = any(status.state is CaptureState.OPENING for status in cameras)
    return "starting" if opening else "blind"


def delivers(status: CaptureStatus) -> bool:
    """True while the camera delivers frames."""
    return status.state is CaptureState.LIVE and not status.is_silent
