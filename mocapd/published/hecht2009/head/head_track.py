"""The state of a tracked head."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from mocapd.published.hecht2009.face.face_detection import FaceBox
from mocapd.types import Bytes, Floats


class HeadState(StrEnum):
    """`lost`: no head; `found`: a face is detected but not confirmed as live; `tracked`."""

    LOST = "lost"
    FOUND = "found"
    TRACKED = "tracked"


@dataclass(frozen=True, slots=True, eq=False)
class HeadPicture:
    """One camera's picture (h,w,3) uint8 BGR, exposed offset_s after the requested instant; None: it has none.

    foreground (h,w) uint8: 0 on the background; None: unknown.
    """

    pixels: Bytes | None
    offset_s: float = 0.0
    foreground: Bytes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class HeadTrack:
    """A head in one instant, world frame [m].

    middle_m (3,): the head's middle; None where lost. sigma_along_m: one standard deviation along the ray of the nearest
    camera. yaw_rad: the face's direction, 0 along +Z, positive to the person's left; None: unknown. boxes: this
    head's face detections in this instant. support: score of colours and outline, about 0..2.
    """

    state: HeadState
    middle_m: Floats | None = None
    sigma_along_m: float = float(np.inf)
    yaw_rad: float | None = None
    boxes: tuple[FaceBox | None, ...] = ()
    support: float = 0.0
