"""A network camera as a kind of source."""

from mocapd.boundary.urls import without_password
from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.url import UrlSource

_SCHEMES = ("rtsp", "rtsps", "http", "https")


def _matches(address: str) -> bool:
    return address.partition(":")[0].lower() in _SCHEMES


def _open(address: str, request: SourceRequest) -> Source:
    name = request.name or without_password(address)
    return UrlSource(name, address, request.size_px, reduced_by=request.reduced_by)


URL = SourceKind(
    form="an rtsp:// or http:// URL", link=CameraLink.NETWORK, matches=_matches, open=_open
)
