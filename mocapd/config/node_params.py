"""The section [node] of the configuration, for camera nodes."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

Side = Annotated[int, Meta(ge=16, le=8192)]


@dataclass(frozen=True, slots=True)
class Params:
    """Settings of `mocapd camera-node` in addition to [[camera]] and [zenoh].

    size_px: width and height requested from the webcams [px]
    jpeg_quality: JPEG quality for cameras that deliver no JPEG, 1 to 100
    paired_user: the client that may set the cameras' controls: a user of zenoh.password_file, or with
      zenoh.tls_require_client the name (CN) in the certificate; empty: none
    router_decides: behind a router, which hides the clients: accept all control messages that its access control permits
    """

    size_px: tuple[Side, Side] = (640, 480)
    jpeg_quality: Annotated[int, Meta(ge=1, le=100)] = 90
    paired_user: Annotated[str, Meta(max_length=64)] = ""
    router_decides: bool = False
