"""Skeleton frames as SteamVR's trackers, by the driver VMT; see `vmt_bundle` for the messages, `steamvr_space` for where."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from mocapd.outputs.base import SinkStatus
from mocapd.outputs.confident_trackers import BEGINS_ABOVE, ConfidentTrackers
from mocapd.outputs.facing import facing_yaw_rad
from mocapd.outputs.messages import Facing, StateMessage
from mocapd.outputs.osc.osc_sink import Destination, parse_destination, status_of
from mocapd.outputs.vmt.steamvr_space import eyes_m, room_position, room_rotation, turn_by
from mocapd.outputs.vmt.vmt_bundle import VmtBundle
from mocapd.outputs.wire import Joint, Quaternion, SkeletonFrame, Vector
from mocapd.outputs.worn_trackers import WornTracker, trackers_of

KEY = "vmt.destination"
# all of them: which are used, and as what, is said in SteamVR
TRACKERS = trackers_of(("hip", "feet", "chest", "knees", "elbows"))
_HEAD_ON = "neck"  # the bone whose confidence tells how well the place of the head is known

Pose = tuple[Vector, Quaternion]


@dataclass(frozen=True, slots=True)
class Params:
    """What goes to SteamVR. Raises ConfigError for a destination that does not do.

    destination: where the driver VMT listens, `address:port`, numeric addresses only
    anchor: `room`: mocapd's origin is that of SteamVR's play area; `headset`: the body hangs below the headset
    """

    destination: str = "127.0.0.1:39570"
    anchor: Literal["room", "headset"] = "room"

    def __post_init__(self) -> None:
        parse_destination(self.destination, KEY)


class VmtSink:
    """Sends each frame's trackers; one that is not seen is switched off. Nobody listening is counted, not an error.

    `tell` and `status` from any thread.
    """

    name = "vmt"

    def __init__(self, params: Params) -> None:
        self._params = params
        self._trackers = ConfidentTrackers(TRACKERS)
        self._bundle = VmtBundle([one.number for one in TRACKERS], params.anchor == "headset")
        self._turn = turn_by(0.0)
        self._asked: deque[None] = deque(maxlen=1)  # the newest wish alone; its calls are atomic
        self._destination: Destination | None = None
        self._is_shown = False  # whether SteamVR has a tracker that is on

    def open(self) -> None:
        """Open the socket. Raises UnavailableError for an address without a route."""
        self.close()
        self._destination = Destination(self._params.destination, KEY)

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame of the first person."""
        there = self._destination
        if there is None or frame.person != 0:
            return
        seen = self._trackers.update(frame)
        self._take_forward(frame)
        origin_m = self._origin_m(frame.joints)
        poses = [
            self._pose(frame.joints, one, origin_m)
            if one in seen and origin_m is not None
            else None
            for one in TRACKERS
        ]
        self._is_shown = any(poses)
        there.send([self._bundle.filled(poses)])

    def _take_forward(self, frame: SkeletonFrame) -> None:
        """A wish waits for a person of whom it is known where it faces."""
        if self._asked and (facing_rad := facing_yaw_rad(frame)) is not None:
            self._asked.clear()
            self._turn = turn_by(-facing_rad)

    def _origin_m(self, joints: Mapping[str, Joint]) -> Vector | None:
        """What places are relative to, in mocapd's world [m]; None: the head is not known, and all hangs on it."""
        if self._params.anchor == "room":
            return (0.0, 0.0, 0.0)
        head, below = joints.get("head"), joints.get(_HEAD_ON)
        is_known = head is not None and below is not None and below.c > BEGINS_ABOVE
        return eyes_m(head) if is_known and head is not None else None

    def _pose(self, joints: Mapping[str, Joint], tracker: WornTracker, origin_m: Vector) -> Pose:
        at = joints[tracker.place].p
        apart = at[0] - origin_m[0], at[1] - origin_m[1], at[2] - origin_m[2]
        turned = room_rotation(joints[tracker.turn].r, self._turn)
        return room_position(apart, self._turn), turned

    def tell(self, message: StateMessage) -> None:
        """The way a person faces becomes forward, in the next frame in which it is seen; else nothing."""
        if isinstance(message, Facing) and message.person == 0:
            self._asked.append(None)

    def status(self) -> SinkStatus:
        """Those that were sent; also which of the trackers are not seen."""
        there = self._destination
        status = status_of([] if there is None else [there])
        missing = ", ".join(one.label for one in self._trackers.missing)
        return (
            replace(status, detail=f"{status.detail}; not seen: {missing}") if missing else status
        )

    def close(self) -> None:
        """Switch the trackers off, and close the socket; may be called twice."""
        there, self._destination = self._destination, None
        if there is None:
            return
        if self._is_shown:
            self._is_shown = False
            there.send([self._bundle.filled([None] * len(TRACKERS))])
        there.close()
