"""In one word: whether a service tracks, or could."""

from typing import Literal

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.service.service import Snapshot
from mocapd.types import Tracking

Fitness = Literal["tracking", "nobody", "slow", "starting", "blind"]

FITNESSES: tuple[Fitness, ...] = ("tracking", "nobody", "slow", "starting", "blind")


def fitness_of(snapshot: Snapshot) -> Fitness:
    """tracking: somebody is followed; nobody: cameras deliver, and nobody is seen; slow: so many frame sets are skipped
    that neither can be relied on; starting: nothing has come out yet; blind: no camera delivers."""
    cameras = snapshot.cameras.values()
    if any(delivers(one) for one in cameras):
        if snapshot.metrics.slowness is not None:
            return "slow"
        if snapshot.metrics.tracking is not Tracking.LOST:
            return "tracking"
        return "nobody" if snapshot.metrics.published else "starting"
    opening = any(one.state is CaptureState.OPENING for one in cameras)
    return "starting" if opening else "blind"


def delivers(status: CaptureStatus) -> bool:
    """Whether frames come from it now."""
    return status.state is CaptureState.LIVE and not status.is_silent
