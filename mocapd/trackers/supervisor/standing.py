"""Whether a tracker is believed: hysteresis in quality and in time."""

from dataclasses import dataclass

from mocapd.clock import nanoseconds
from mocapd.trackers.base import Track
from mocapd.trackers.supervisor.kinds import Kind
from mocapd.trackers.supervisor.params import Params
from mocapd.types import Tracking


@dataclass(frozen=True, slots=True)
class Standing:
    """since_ns: since when every track told the opposite of `believed`; None when the last one did not."""

    believed: bool = False
    since_ns: int | None = None


def judged(before: Standing, track: Track, cameras: int, kind: Kind, params: Params) -> Standing:
    """After another track, of a frame set of so many cameras."""
    body = track.body
    if body.tracking is Tracking.LOST:
        return Standing()
    live = body.tracking is Tracking.LIVE
    if before.believed:
        opposite, needed_s = not live or track.quality < kind.poor, params.doubt_s
    else:
        opposite = live and track.quality >= kind.good and cameras >= kind.least_cameras
        needed_s = params.confirm_s
    if not opposite:
        return Standing(before.believed)
    since_ns = body.t_ns if before.since_ns is None else before.since_ns
    if body.t_ns - since_ns >= nanoseconds(needed_s):
        return Standing(not before.believed)
    return Standing(before.believed, since_ns)
