"""Webcams as kinds of source: addressed by USB identity, or (off USB) by node."""

from dataclasses import replace
from pathlib import Path

from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.webcam.identity import PREFIX, WebcamIdentity, parse_identity
from mocapd.capture.webcam.v4l2 import V4l2Source


def _is_identity(address: str) -> bool:
    return address.startswith(PREFIX)


def _is_node(address: str) -> bool:
    return address.isdigit() or address.startswith("/dev/")


def _open_identity(address: str, request: SourceRequest) -> Source:
    return _webcam(request.name or address, parse_identity(address), request)


def _open_node(address: str, request: SourceRequest) -> Source:
    node = Path(f"/dev/video{address}" if address.isdigit() else address)
    return _webcam(request.name or node.name, node, request)


def _webcam(name: str, where: WebcamIdentity | Path, request: SourceRequest) -> Source:
    settings = request.settings
    if request.size_px is not None:
        settings = replace(settings, size_px=request.size_px)
    return V4l2Source(name, where, settings, request.others, reduced_by=request.reduced_by)


WEBCAM = SourceKind(
    form="usb:PORT:VID:PID:SERIAL (see `mocapd cameras`)",
    link=CameraLink.USB,
    matches=_is_identity,
    open=_open_identity,
    is_settable=True,
    identity=parse_identity,
)
NODE = SourceKind(
    form="/dev/videoN", link=CameraLink.DEVICE, matches=_is_node, open=_open_node, is_settable=True
)
