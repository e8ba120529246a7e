"""Skeleton frames as VRChat's OSC trackers over UDP; trackers: `worn_trackers`, coordinates: `tracker_bundle`."""

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.confident_trackers import ConfidentTrackers, confident_head
from mocapd.outputs.facing import facing_yaw_rad
from mocapd.outputs.messages import Facing, StateMessage
from mocapd.outputs.osc.osc_sink import parse_destination
from mocapd.outputs.quaternions import IDENTITY_XYZW
from mocapd.outputs.rate_cap import RateCap
from mocapd.outputs.vrchat import tracker_bundle
from mocapd.outputs.vrchat.head_alignment import HeadAlignment
from mocapd.outputs.vrchat.tracker_bundle import (
    TrackerBundle,
    cos_sin,
    unity_euler_deg,
    unity_position,
)
from mocapd.outputs.vrchat.vrchat_link import KEY, VRChatLink
from mocapd.outputs.wire import Joint, SkeletonFrame, Vector
from mocapd.outputs.worn_trackers import BodyPart, WornTracker, trackers_of

if TYPE_CHECKING:
    from mocapd.outputs.vrchat.vrchat_finder import VRChatFinder

AUTO = "auto"

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Params:
    """What goes to VRChat. Raises ConfigError for a destination that does not do.

    destination: where VRChat listens, `address:port`, numeric addresses only; `auto`: found in the local network, needs the
      extra `mocapd[vrchat]`
    trackers: which trackers are sent: hip, feet, chest, knees, elbows; a few good ones work better than all
    head: send the position of the head, by which VRChat aligns the body with the headset
    rate_hz: frames a second at most [Hz]
    yaw_deg: rotates all trackers about the vertical, to the person's left [deg]
    """

    destination: str = "127.0.0.1:9000"
    trackers: tuple[BodyPart, ...] = ("hip", "feet")
    head: bool = True
    rate_hz: Annotated[float, Meta(ge=1, le=200)] = 60.0
    yaw_deg: Annotated[float, Meta(ge=-360, le=360)] = 0.0

    def __post_init__(self) -> None:
        if self.destination == AUTO:
            return
        try:
            parse_destination(self.destination)
        except ConfigError as error:
            raise ConfigError(
                error.what, KEY, 'write for example 127.0.0.1:9000 (not localhost), or "auto"'
            ) from None


class VRChatSink:
    """Sends each frame's confident trackers. Frames without a listener are counted, not an error.

    `send_state` and `status` from any thread.
    """

    name = "vrchat"

    def __init__(self, params: Params, finder: "VRChatFinder | None" = None) -> None:
        """finder: used where the destination is `auto`."""
        self._params = params
        self._finder = (finder or _new_finder()) if params.destination == AUTO else None
        self._link = VRChatLink()
        self._trackers = ConfidentTrackers(trackers_of(params.trackers))
        self._alignment = HeadAlignment(math.radians(params.yaw_deg))
        self._cap = RateCap(params.rate_hz)
        self._bundles: dict[tuple[str, ...], TrackerBundle] = {}  # by addresses, 1024 at most

    def open(self) -> None:
        """Open the socket, or start the search for VRChat. Raises UnavailableError for an address without a route,
        ConfigError where the library for the search is not installed."""
        self.close()
        if self._finder is None:
            self._link.aim(self._params.destination)
        else:
            self._finder.start()

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame's confident trackers as one bundle; nothing without any, or above `rate_hz`."""
        now_ns = frame.publish_monotonic_ns
        trackers = self._trackers.update(frame)
        if not trackers or not self._cap.takes(now_ns):
            return
        if self._finder is not None:
            self._follow(self._finder.address)
        if not self._link.is_aimed:
            self._link.refuse()  # a recenter request stays pending
            return
        is_aligned = self._alignment.take(now_ns, facing_yaw_rad(frame))
        vectors = self._vectors(frame.joints, trackers, is_aligned)
        addresses = tuple(vectors)
        bundle = self._bundles.get(addresses)
        if bundle is None:
            bundle = self._bundles[addresses] = TrackerBundle(addresses)
        self._link.send(bundle.fill(tuple(vectors.values())))

    def _follow(self, address: str | None) -> None:
        """Use the address that the search found."""
        try:
            self._link.aim(address)
        except UnavailableError as error:
            _log.warning("VRChat cannot be sent to: %s", error)

    def _vectors(
        self, joints: Mapping[str, Joint], trackers: tuple[WornTracker, ...], is_aligned: bool
    ) -> dict[str, Vector]:
        """The vectors to send by OSC address, the head first: receivers place the others relative to it."""
        turn_rad = self._alignment.turn_rad
        turn, half_turn = cos_sin(turn_rad), cos_sin(0.5 * turn_rad)
        vectors: dict[str, Vector] = {}
        head = confident_head(joints)
        if self._params.head and head is not None:
            vectors[tracker_bundle.HEAD_POSITION] = unity_position(head.p, turn)
        if is_aligned:
            # without pitch and roll: VRChat uses the yaw
            half_forward = cos_sin(0.5 * self._alignment.forward_rad)
            vectors[tracker_bundle.HEAD_ROTATION] = unity_euler_deg(IDENTITY_XYZW, half_forward)
        for tracker in trackers:
            place, rotation = joints[tracker.place].p, joints[tracker.turn].r
            vectors[tracker_bundle.position_address(tracker.number)] = unity_position(place, turn)
            vectors[tracker_bundle.rotation_address(tracker.number)] = unity_euler_deg(
                rotation, half_turn
            )
        return vectors

    def send_state(self, message: StateMessage) -> None:
        """On a Facing message: recenter in the next frame with a facing direction. Ignores other messages."""
        if isinstance(message, Facing):
            self._alignment.ask()

    def status(self) -> SinkStatus:
        """Frames sent; the detail names the untracked trackers."""
        status = self._link.status()
        if self._finder is not None and self._finder.address is None:
            status = replace(status, detail=self._finder.detail)
        return self._trackers.with_missing(status)

    def close(self) -> None:
        """Stop the search, close the socket; may be called twice."""
        if self._finder is not None:
            self._finder.stop()
        self._link.close()


def warnings(params: Params) -> tuple[str, ...]:
    """One warning for each permitted but unsafe setting."""
    if params.destination != AUTO:
        return ()
    return (
        'vrchat.destination = "auto": whoever announces a VRChat in the local network is sent where the'
        " person is, unencrypted; give VRChat's address where you do not trust the network",
    )


def _new_finder() -> "VRChatFinder":
    # imported here: its HTTP client comes with TLS, which other starts do without
    from mocapd.outputs.vrchat.vrchat_finder import VRChatFinder

    return VRChatFinder()
