"""Selects the trackers to send by the confidence of their bones, with hysteresis.

VRChat and SteamVR have no field for confidence: they believe every tracker they receive. For a missing tracker the
avatar's own animation does better than our guess. A bone without evidence (the legs, for the shirt tracker) has a
confidence of 0. A bone in one camera's view has 0.2 to 0.5: its position is 10 cm off, its motion is right. The upper
threshold lies below that range, the lower one well below, because the avatar shows every start and stop.
"""

from collections.abc import Mapping
from dataclasses import replace

from mocapd.outputs.base import SinkStatus
from mocapd.outputs.wire import Joint, SkeletonFrame
from mocapd.outputs.worn_trackers import WornTracker

BEGINS_ABOVE = 0.15  # confidence
ENDS_BELOW = 0.07  # a predicted pose falls below within a fifth of a second


class ConfidentTrackers:
    """The current selection. For one thread."""

    def __init__(self, trackers: tuple[WornTracker, ...]) -> None:
        self._trackers = trackers
        self.sent: tuple[WornTracker, ...] = ()

    def update(self, frame: SkeletonFrame) -> tuple[WornTracker, ...]:
        """The trackers to send with this frame; none when it is lost."""
        joints, before = frame.joints, self.sent
        self.sent = tuple(
            tracker
            for tracker in self._trackers
            if _confidence(tracker, joints) > (ENDS_BELOW if tracker in before else BEGINS_ABOVE)
        )
        return self.sent

    def with_missing(self, status: SinkStatus) -> SinkStatus:
        """The status with the names of the trackers that are not in the current selection."""
        missing = ", ".join(tracker.label for tracker in self._trackers if tracker not in self.sent)
        return (
            replace(status, detail=f"{status.detail}; not seen: {missing}") if missing else status
        )


def confident_head(joints: Mapping[str, Joint]) -> Joint | None:
    """The head, if its position is confident: as much as the neck is."""
    head, below = joints.get("head"), joints.get("neck")
    return head if below is not None and below.c > BEGINS_ABOVE else None


def _confidence(tracker: WornTracker, joints: Mapping[str, Joint]) -> float:
    """The lower confidence of its two bones; 0 where a bone is missing."""
    place, turn = joints.get(tracker.place), joints.get(tracker.turn)
    return 0.0 if place is None or turn is None else min(place.c, turn.c)
