"""What a kind of source says of itself: the record that the table `source_kinds` is made of."""

from collections.abc import Callable
from dataclasses import dataclass

from mocapd.capture.base import Source
from mocapd.capture.origin import OriginKind
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.webcam.identity import WebcamIdentity


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SourceKind:
    """One way to write where a camera is read from: its address.

    form: how it is written, for people. matches(address): whether it is written so. open(address, request):
    its source, checked but not opened yet; raises ConfigError or InputError. is_path: a relative address is
    meant from the file that holds it. is_settable: it delivers the size that it is asked for. identity: of
    the webcam that an address names; raises ConfigError. origin: where several such cameras are of. Whether
    its frames are of the past is said by the source itself, and a password in an address is hidden by
    `boundary.urls`, whatever the kind.
    """

    form: str
    matches: Callable[[str], bool]
    open: Callable[[str, SourceRequest], Source]
    is_path: bool = False
    is_settable: bool = False
    is_simulated: bool = False
    identity: Callable[[str], WebcamIdentity] | None = None
    origin: OriginKind | None = None
