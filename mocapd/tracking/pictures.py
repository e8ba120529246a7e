"""Pictures of a frame set, downscaled and in grey: each is computed once, for all cues."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from mocapd.clock import seconds
from mocapd.each import Each, in_turn
from mocapd.fit.work_size import image_scales, work_size
from mocapd.types import Bytes, Camera, Frame, FrameSet
from mocapd.vision.frame_size import check_frame_size


@dataclass(slots=True, eq=False)
class CameraPicture:
    """The newest picture of one camera, bgr (h,w,3), downscaled by image_scale; both sides are even."""

    camera: Camera
    image_scale: int
    bgr: Bytes = field(init=False)
    _frame: Frame | None = field(init=False, default=None)
    _grey: Bytes | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        w, h = work_size(self.camera, self.image_scale)
        self.bgr = np.zeros((h, w, 3), np.uint8)

    def take(self, frame: Frame) -> None:
        """Stores a frame, averaged over blocks."""
        self._frame, self._grey = frame, None
        h, w = self.bgr.shape[:2]
        small, by = frame.small(self.image_scale)
        k = self.image_scale // by
        cv2.resize(small[: h * k, : w * k], (w, h), dst=self.bgr, interpolation=cv2.INTER_AREA)

    @property
    def grey(self) -> Bytes:
        """The whole picture in grey (h,w); black before the first."""
        if self._grey is None:
            picture = None if self._frame is None else self._frame.picture
            if picture is None:
                self._grey = np.zeros(self.camera.size_px[::-1], np.uint8)
            elif isinstance(picture, np.ndarray):
                self._grey = np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)
            else:
                self._grey = picture.grey
        return self._grey


class Pictures:
    """The newest picture of each camera of a rig.

    t_ns: time of the frame set; present: each present camera's time offset from it [s], by index.
    """

    def __init__(self, cameras: Sequence[Camera], work_width_px: int, each: Each = in_turn) -> None:
        scales = image_scales(cameras, work_width_px)
        self.each = [CameraPicture(c, k) for c, k in zip(cameras, scales, strict=True)]
        self.t_ns, self.present = 0, dict[int, float]()
        self._index = {camera.name: i for i, camera in enumerate(cameras)}
        self._each = each

    def grey(self, index: int) -> Bytes:
        """A camera's picture as delivered, in grey (h,w)."""
        return self.each[index].grey

    def load(self, frames: FrameSet) -> dict[int, float]:
        """Loads a frame set and returns `present`. Raises ConfigError when a frame's size is not its calibration's."""
        mine = sorted((self._index[n], f) for n, f in frames.frames.items() if n in self._index)
        for i, frame in mine:
            check_frame_size(frame, self.each[i].camera.size_px)
        self._each(lambda item: self.each[item[0]].take(item[1]), mine)
        self.t_ns = frames.t_ns
        self.present = {i: seconds(frame.t_ns - frames.t_ns) for i, frame in mine}
        return self.present
