"""The record of one kind of source; `source_kinds` is a table of them."""

from collections.abc import Callable
from dataclasses import dataclass

from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.origin import OriginKind
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.webcam.identity import WebcamIdentity


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SourceKind:
    """One form of a camera's address.

    form: its syntax, for users. link: where its frames can be lost. matches(address): whether an address has this form.
    open(address, request): the source, checked but not opened; raises ConfigError or InputError. is_path: a relative
    address is relative to the file that holds it. is_settable: the camera can deliver a requested size. identity: of
    the webcam at an address; raises ConfigError. origin: the recording or scenario that several cameras share.
    """

    form: str
    link: CameraLink
    matches: Callable[[str], bool]
    open: Callable[[str, SourceRequest], Source]
    is_path: bool = False
    is_settable: bool = False
    is_simulated: bool = False
    identity: Callable[[str], WebcamIdentity] | None = None
    origin: OriginKind | None = None
