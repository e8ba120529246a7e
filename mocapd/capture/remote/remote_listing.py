"""Lists the cameras of a camera node, or of all nodes behind a router (`mocapd cameras --at`)."""

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
    """One remote camera. spec: its address for the configuration, without the password."""

    state: CameraState
    spec: str


def list_remote(place: str) -> tuple[RemoteInfo, ...]:
    """The cameras by node and name. Raises ConfigError, or UnavailableError without an answer."""
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
        RemoteInfo(state, address_of(shown, state.node, state.camera))
        for state in sorted(states, key=lambda state: (state.node, state.camera))
    )
