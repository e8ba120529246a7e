"""What cameras there are at a camera node, or at all that joined a router (`mocapd cameras --at`)."""

from dataclasses import dataclass

from mocapd.boundary.urls import without_password
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import CameraState
from mocapd.capture.remote.remote_address import address_of, parse_place
from mocapd.capture.remote.remote_link import RemoteLink
from mocapd.errors import UnavailableError

_ANSWER_S = 2.0


@dataclass(frozen=True, slots=True)
class RemoteInfo:
    """One of them. spec: what to write into the config, but for the password."""

    state: CameraState
    spec: str


def list_remote(place: str) -> tuple[RemoteInfo, ...]:
    """By node and name. Raises ConfigError, or UnavailableError when nobody answers there."""
    address = parse_place(place)
    link = RemoteLink(address)
    try:
        key = camera_wire.state(address.node, address.camera)
        states = link.ask_all(key, CameraState, None, _ANSWER_S)
    finally:
        link.close()
    if not states:
        raise UnavailableError(
            "there is no camera node", address.endpoint, "start `mocapd camera-node`"
        )
    shown = without_password(place)
    return tuple(
        RemoteInfo(one, address_of(shown, one.node, one.camera))
        for one in sorted(states, key=lambda one: (one.node, one.camera))
    )
