"""A network camera as a kind of source."""

from mocapd.boundary.urls import without_password
from mocapd.capture.base import Source
from mocapd.capture.source_kind import Asked, SourceKind
from mocapd.capture.url import UrlSource

_SCHEMES = ("rtsp", "rtsps", "http", "https")


def _matches(address: str) -> bool:
    return address.partition(":")[0].lower() in _SCHEMES


def _open(address: str, asked: Asked) -> Source:
    return UrlSource(asked.name or without_password(address), address, asked.size_px)


URL = SourceKind(form="an rtsp:// or http:// URL", matches=_matches, open=_open)
