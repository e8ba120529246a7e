"""What is known of a head in one instant."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from mocapd.types import Bytes, Floats
from mocapd.vision.face.face_detection import FaceBox


class HeadState(StrEnum):
    """`lost`: no head is known; `found`: a face is seen, but not that it belongs to somebody alive; `tracked`."""

    LOST = "lost"
    FOUND = "found"
    TRACKED = "tracked"


class StereoFault(StrEnum):
    """Why the cameras give no depth; then it comes from the head's apparent size."""

    NONE = ""
    NO_BASELINE = "the cameras are in one place"
    SWAPPED = "the face lies behind the cameras: left and right are swapped"


@dataclass(frozen=True, slots=True, eq=False)
class HeadPicture:
    """One camera's picture (h,w,3) uint8 BGR, exposed offset_s after the instant that is asked for; None: it has none.

    foreground (h,w) uint8: 0 where the background shows; None: it is not known.
    """

    pixels: Bytes | None
    offset_s: float = 0.0
    foreground: Bytes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class HeadTrack:
    """A head in one instant, world frame [m].

    joint_m (3,): the skeleton's head joint; middle_m: the head's middle; face_m: the middle of the face; None where
    lost. velocity_m_s (3,). sigma_along_m, sigma_across_m: one standard deviation along the ray of the nearest
    camera and across it. yaw_rad: which way the face looks, 0 along +Z, positive to the person's left; None: not
    seen. boxes: each camera's face of this head as seen in this instant. support: of colours and outline, about 0..2.
    """

    state: HeadState
    joint_m: Floats | None = None
    middle_m: Floats | None = None
    face_m: Floats | None = None
    velocity_m_s: Floats | None = None
    sigma_along_m: float = float(np.inf)
    sigma_across_m: float = float(np.inf)
    yaw_rad: float | None = None
    boxes: tuple[FaceBox | None, ...] = ()
    support: float = 0.0
    fault: StereoFault = StereoFault.NONE
