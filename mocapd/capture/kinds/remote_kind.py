"""A camera of a camera node as a kind of source."""

from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.remote.remote_address import FORM, is_remote, parse_remote
from mocapd.capture.source_request import SourceRequest


def _open(address: str, request: SourceRequest) -> Source:
    from mocapd.capture.remote.remote_source import RemoteSource  # imports Zenoh

    remote = parse_remote(address)
    name = request.name or remote.place
    return RemoteSource(name, remote, request.size_px, request.settings, request.reduced_by)


REMOTE = SourceKind(form=FORM, link=CameraLink.NETWORK, matches=is_remote, open=_open)
