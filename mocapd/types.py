"""The data types between stages: frozen records of arrays, without computation.

Frames of reference (the only place where axes are defined):

| name | axes | unit |
|---|---|---|
| world | right-handed, +Y up, origin on the floor of the play area; at rest a person faces +Z, its left is +X | m |
| camera | OpenCV: x right, y down, z forward; x_camera = R x_world + t | m |
| image | x right, y down, pixel centres at integers | px |
| bone | the world's axes, turned by the bone's global rotation; identity in the T-pose | m |

Quaternions are xyzw with w >= 0. Arrays are read-only by convention after construction.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]
Bytes = NDArray[np.uint8]


class CompressedPicture(Protocol):
    """A picture as the camera delivered it, decoded as far as somebody asks; see `JpegPicture`."""

    @property
    def encoded(self) -> bytes:
        """The file."""
        ...

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the whole picture."""
        ...

    @property
    def pixels(self) -> Bytes:
        """The whole picture (h,w,3)."""
        ...

    @property
    def grey(self) -> Bytes:
        """The whole picture in grey (h,w)."""
        ...

    @property
    def small(self) -> Bytes:
        """The picture (h,w,3), averaged over blocks of `reduced_by` pixels each way."""
        ...

    @property
    def reduced_by(self) -> int:
        """Of `small`; 1 for the whole picture."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One picture of one camera.

    `t_ns` is the best estimate of the middle of the exposure on CLOCK_MONOTONIC (for webcams: the
    driver's stamp), not the time of arrival. `seq` counts the source's frames; gaps are lost
    frames. `picture`: pixels (height, width, 3) uint8 BGR, C-contiguous, read-only, or what they are decoded from.
    """

    camera: str
    seq: int
    t_ns: int
    picture: Bytes | CompressedPicture

    @property
    def pixels(self) -> Bytes:
        """The whole picture (h,w,3). May decode it: see `small`."""
        return self.picture if isinstance(self.picture, np.ndarray) else self.picture.pixels

    @property
    def encoded(self) -> bytes | None:
        """The JPEG as the camera delivered it; None where it delivered none."""
        return None if isinstance(self.picture, np.ndarray) else self.picture.encoded

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the whole picture."""
        if not isinstance(self.picture, np.ndarray):
            return self.picture.size_px
        h, w = self.picture.shape[:2]
        return w, h

    def small(self, scale: int) -> tuple[Bytes, int]:
        """The smallest picture at hand that can be averaged down to one `scale` times smaller, and by how much it is
        smaller itself: a divisor of `scale`."""
        if isinstance(self.picture, np.ndarray):
            return self.picture, 1
        by = self.picture.reduced_by
        return (self.picture.small, by) if scale % by == 0 else (self.picture.pixels, 1)


@dataclass(frozen=True, slots=True, eq=False)
class FrameSet:
    """Simultaneous frames of several cameras; a camera without a frame is absent.

    `t_ns` is the time of the requested pose: for live cameras that of the newest frame, for a
    recorded folder that of the rig's first present camera. `spread_ns` is the largest
    distance of a frame's own time from `t_ns`.
    """

    t_ns: int
    frames: Mapping[str, Frame]
    spread_ns: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class LabelledPicture:
    """A picture and a person's strokes on it: pixels (h,w,3) uint8 BGR; labels (h,w) uint8, 0 none, 1..10
    the shirt's colour ids."""

    pixels: Bytes
    labels: Bytes


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A calibrated camera: intrinsics K (3,3) [px], dist (5,) k1 k2 p1 p2 k3, and camera_from_world R (3,3), t_m (3,)."""

    name: str
    size_px: tuple[int, int]  # width, height
    K: Floats
    dist: Floats
    R: Floats
    t_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """The cameras of one calibration, in a fixed order; their names are unique."""

    cameras: tuple[Camera, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(camera.name for camera in self.cameras)


@dataclass(frozen=True, slots=True, eq=False)
class Skeleton:
    """Bones (VRM 1.0 names), parents (J,) with -1 at the root, and T-pose joint centres rest_m (J,3) [m], floor at y = 0."""

    names: tuple[str, ...]
    parents: Ints
    rest_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """root_m (3,): the hips joint in the world; quats_xyzw (J,4): global rotations relative to the T-pose."""

    root_m: Floats
    quats_xyzw: Floats


class Tracking(StrEnum):
    """`live`: evidence in this frame; `coasting`: briefly predicted; `lost`: no pose."""

    LIVE = "live"
    COASTING = "coasting"
    LOST = "lost"


@dataclass(frozen=True, slots=True, eq=False)
class BodyState:
    """A person at one instant. Lost: `pose` and `joints_m` are None and every confidence is 0.

    joints_m (J,3) [m, world]; confidence (J,) in 0..1, near 0 for a joint without evidence;
    `cameras`: names of the cameras whose evidence was used; smoothing_lag_ns: approximate lag of a moving person's
    pose by the tracker's filter and smoothing; uncertainty_m (J,): one standard deviation of each joint's position, the
    root mean square over the world's axes [m], inf where unknown; omitted if the tracker estimates none.
    """

    t_ns: int
    tracking: Tracking
    tracker: str
    pose: Pose | None
    joints_m: Floats | None
    confidence: Floats
    cameras: tuple[str, ...] = ()
    smoothing_lag_ns: int = 0
    uncertainty_m: Floats = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        if len(self.uncertainty_m) == 0:
            object.__setattr__(self, "uncertainty_m", np.full(len(self.confidence), np.inf))
