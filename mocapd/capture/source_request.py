"""The parameters of opening a source."""

from dataclasses import dataclass, field

from mocapd.capture.pace import Pace
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.v4l2 import WebcamSettings


@dataclass(frozen=True, slots=True, eq=False)
class SourceRequest:
    """name: what to call the camera; without it, what its address says. size_px: width and height of its
    calibration; another size is an error. settings: for webcams; `size_px` overrules theirs. others: the
    identities of the other configured webcams, which are never taken for this one. pace: shared by
    recordings that belong together; offline when not given. reduced_by: how many times smaller a camera's JPEG is decoded
    at first, see `JpegPicture`.
    """

    name: str | None = None
    size_px: tuple[int, int] | None = None
    settings: WebcamSettings = field(default_factory=WebcamSettings)
    others: tuple[WebcamIdentity, ...] = ()
    pace: Pace = field(default_factory=lambda: Pace(live=False))
    reduced_by: int = 1
