"""Which trackers are sent: those whose bones are seen. One that only follows another bone is not.

VRChat and SteamVR cannot be told of doubt: a tracker that is sent is believed, and of one that is not sent the avatar's
own animation does better than a guess of ours. A bone that a tracker of mocapd does not look at, as the legs of somebody
in the shirt, has a confidence of 0; one that a single camera sees, some 0.2 to 0.5: its place is 10 cm off, its way of
moving is right. It begins below those, and ends well below, as every begin and end is seen on the avatar.
"""

from collections.abc import Mapping

from mocapd.outputs.wire import Joint, SkeletonFrame
from mocapd.outputs.worn_trackers import WornTracker

BEGINS_ABOVE = 0.15  # confidence
ENDS_BELOW = 0.07  # a predicted pose falls below within a fifth of a second


class ConfidentTrackers:
    """Keeps which of these are sent. For one thread."""

    def __init__(self, trackers: tuple[WornTracker, ...]) -> None:
        self._trackers = trackers
        self.sent: tuple[WornTracker, ...] = ()

    def update(self, frame: SkeletonFrame) -> tuple[WornTracker, ...]:
        """Those that are sent with this frame, by number; none when it is lost."""
        joints, before = frame.joints, self.sent
        self.sent = tuple(
            one
            for one in self._trackers
            if _confidence(one, joints) > (ENDS_BELOW if one in before else BEGINS_ABOVE)
        )
        return self.sent

    @property
    def missing(self) -> tuple[WornTracker, ...]:
        """Those that are wanted and were not sent last."""
        return tuple(one for one in self._trackers if one not in self.sent)


def _confidence(tracker: WornTracker, joints: Mapping[str, Joint]) -> float:
    """Of the less known of its bones; 0 where there is none."""
    place, turn = joints.get(tracker.place), joints.get(tracker.turn)
    return 0.0 if place is None or turn is None else min(place.c, turn.c)
