"""Skeleton frames as SteamVR's trackers, by the driver VMT; messages and coordinates: `vmt_bundle`."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from mocapd.outputs.base import SinkStatus
from mocapd.outputs.confident_trackers import ConfidentTrackers, confident_head
from mocapd.outputs.facing import facing_yaw_rad
from mocapd.outputs.messages import Facing, StateMessage
from mocapd.outputs.osc.osc_sink import Destination, parse_destination, status_of
from mocapd.outputs.vmt.vmt_bundle import VmtBundle, eyes_m, room_position, room_rotation, turn_by
from mocapd.outputs.wire import Joint, Quaternion, SkeletonFrame, Vector
from mocapd.outputs.worn_trackers import WornTracker, trackers_of

KEY = "vmt.destination"
# all of them: the user assigns them in SteamVR
TRACKERS = trackers_of(("hip", "feet", "chest", "knees", "elbows"))

Pose = tuple[Vector, Quaternion]


@dataclass(frozen=True, slots=True)
class Params:
    """What goes to SteamVR. Raises ConfigError for a destination that does not do.

    destination: address of the driver VMT, `address:port`, numeric addresses only
    anchor: `room`: mocapd's origin is that of SteamVR's play area; `headset`: positions are relative to the headset
    """

    destination: str = "127.0.0.1:39570"
    anchor: Literal["room", "headset"] = "room"

    def __post_init__(self) -> None:
        parse_destination(self.destination, KEY)


class VmtSink:
    """Sends each frame's trackers; untracked ones are switched off. Frames without a listener are counted, no error.

    `send_state` and `status` from any thread.
    """

    name = "vmt"

    def __init__(self, params: Params) -> None:
        self._params = params
        self._trackers = ConfidentTrackers(TRACKERS)
        numbers = [tracker.number for tracker in TRACKERS]
        self._bundle = VmtBundle(numbers, params.anchor == "headset")
        self._turn = turn_by(0.0)
        # a pending recenter request; deque's calls are atomic
        self._asked: deque[None] = deque(maxlen=1)
        self._destination: Destination | None = None
        self._is_shown = False  # whether any tracker is switched on in SteamVR

    def open(self) -> None:
        """Open the socket. Raises UnavailableError for an address without a route."""
        self.close()
        self._destination = Destination(self._params.destination, KEY)

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame of the first person."""
        there = self._destination
        if there is None or frame.person != 0:
            return
        tracked = self._trackers.update(frame)
        self._take_forward(frame)
        origin_m = self._origin_m(frame.joints)
        poses = [
            self._pose(frame.joints, tracker, origin_m)
            if tracker in tracked and origin_m is not None
            else None
            for tracker in TRACKERS
        ]
        self._is_shown = any(poses)
        there.send([self._bundle.fill(poses)])

    def _take_forward(self, frame: SkeletonFrame) -> None:
        """Recenter, if requested, in the first frame with a facing direction."""
        if self._asked and (facing_rad := facing_yaw_rad(frame)) is not None:
            self._asked.clear()
            self._turn = turn_by(-facing_rad)

    def _origin_m(self, joints: Mapping[str, Joint]) -> Vector | None:
        """The origin of the positions in mocapd's world [m]; None: it is the head, which is not tracked."""
        if self._params.anchor == "room":
            return (0.0, 0.0, 0.0)
        head = confident_head(joints)
        return None if head is None else eyes_m(head)

    def _pose(self, joints: Mapping[str, Joint], tracker: WornTracker, origin_m: Vector) -> Pose:
        at = joints[tracker.place].p
        apart = at[0] - origin_m[0], at[1] - origin_m[1], at[2] - origin_m[2]
        turned = room_rotation(joints[tracker.turn].r, self._turn)
        return room_position(apart, self._turn), turned

    def send_state(self, message: StateMessage) -> None:
        """On a Facing message: recenter in the next frame with a facing direction. Ignores other messages."""
        if isinstance(message, Facing) and message.person == 0:
            self._asked.append(None)

    def status(self) -> SinkStatus:
        """Frames sent; the detail names the untracked trackers."""
        there = self._destination
        return self._trackers.with_missing(status_of([] if there is None else [there]))

    def close(self) -> None:
        """Switch the trackers off, and close the socket; may be called twice."""
        there, self._destination = self._destination, None
        if there is None:
            return
        if self._is_shown:
            self._is_shown = False
            there.send([self._bundle.fill([None] * len(TRACKERS))])
        there.close()
