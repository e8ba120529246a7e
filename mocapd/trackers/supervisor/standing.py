"""Whether a tracker is believed: hysteresis in quality and in time."""

from dataclasses import dataclass

from mocapd.clock import nanoseconds
from mocapd.trackers.base import Track
from mocapd.trackers.supervisor.kinds import Kind
from mocapd.trackers.supervisor.params import Params
from mocapd.types import Tracking


@dataclass(frozen=True, slots=True)
class TrackerStanding:
    """since_ns: since when every track told the opposite of `believed`; None when the last one did not."""

    believed: bool = False
    since_ns: int | None = None


def is_well(track: Track, cameras: int, kind: Kind) -> bool:
    """Whether a track, of a frame set of so many cameras, is one to be believed."""
    live = track.body.tracking is Tracking.LIVE
    return live and track.quality >= kind.good and cameras >= kind.least_cameras


def judged(
    before: TrackerStanding, track: Track, cameras: int, kind: Kind, params: Params
) -> TrackerStanding:
    """After another track, of a frame set of so many cameras."""
    body = track.body
    if body.tracking is Tracking.LOST:
        return TrackerStanding()
    if before.believed:
        opposite = body.tracking is not Tracking.LIVE or track.quality < kind.poor
        needed_s = params.doubt_s
    else:
        opposite, needed_s = is_well(track, cameras, kind), params.confirm_s
    if not opposite:
        return TrackerStanding(before.believed)
    since_ns = body.t_ns if before.since_ns is None else before.since_ns
    if body.t_ns - since_ns >= nanoseconds(needed_s):
        return TrackerStanding(not before.believed)
    return TrackerStanding(before.believed, since_ns)
