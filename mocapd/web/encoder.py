"""Encodes pictures as JPEG on request, once for all requests for the same picture.

For a picture with a body overlay it takes the newest frame with a pose, so that both match at any rate. A request for
the full width gets the camera's own JPEG unchanged, if there is one."""

import asyncio
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace

import cv2
import numpy as np

from mocapd.boundary.image_decoding import is_plain_jpeg
from mocapd.clock import nanoseconds
from mocapd.errors import MalformedError
from mocapd.pipeline.body_hub import BodySample
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Bytes, Frame
from mocapd.web.links.socket_link import MOST_HZ

NARROWEST_PX, WIDTH_STEP_PX = 64, 32
JPEG_QUALITY = 75
WAIT_S = 1.0  # timeout for a new frame [s]
POSE_AGE_S = 2.0  # a slower tracker does not delay the pictures [s]
_LOOK_EVERY_S = 0.01
_MOST_WIDTHS = 16  # cached sizes


@dataclass(frozen=True, slots=True)
class Picture:
    """One frame as JPEG. size_px: of the camera's whole frame, not of the JPEG; body: the body tracked in it, None without
    one or when not requested."""

    camera: str
    seq: int
    t_ns: int
    size_px: tuple[int, int]
    jpeg: bytes
    body: BodySample | None = None


@dataclass(slots=True)
class _Newest:
    picture: Picture | None = None
    made_s: float = 0.0
    lock: asyncio.Lock = field(default_factory=asyncio.Lock)


class PictureEncoder:
    """Used within one event loop; encodes in `executor`. `encoded` counts the encoded pictures."""

    def __init__(
        self,
        hub: Callable[[], FrameHub | None],
        executor: Executor,
        body: Callable[[], BodySample | None] = lambda: None,
    ) -> None:
        self.encoded = 0
        self._hub, self._body, self.executor = hub, body, executor
        self._newest: dict[tuple[str, int, bool], _Newest] = {}

    async def picture(
        self, camera: str, width_px: int, after_seq: int | None, with_body: bool = False
    ) -> Picture | None:
        """The camera's newest frame whose number is not `after_seq`; with_body: the newest with a pose, unless that is
        older than POSE_AGE_S.

        At most `width_px` wide and never wider than the camera's; None on a timeout. No camera and width is encoded more
        often than MOST_HZ.
        """
        width_px = max(NARROWEST_PX, -(-width_px // WIDTH_STEP_PX) * WIDTH_STEP_PX)
        newest = self._slot(camera, width_px, with_body)
        loop = asyncio.get_running_loop()
        async with newest.lock:
            before, due_s = newest.picture, newest.made_s + 1.0 / MOST_HZ
            if before is not None and before.seq != after_seq and loop.time() < due_s:
                return before
            await asyncio.sleep(due_s - loop.time())
            result = await self._frame(camera, after_seq, with_body)
            if result is None:
                return None
            frame, body = result
            if before is None or frame.seq != before.seq or frame.t_ns != before.t_ns:
                newest.made_s = loop.time()
                before = camera_jpeg(frame, width_px)
                if before is None:
                    before = await loop.run_in_executor(self.executor, encode, frame, width_px)
                    self.encoded += 1
                newest.picture = before = replace(before, body=body)
            return before

    def _slot(self, camera: str, width_px: int, with_body: bool) -> _Newest:
        slot = self._newest.pop((camera, width_px, with_body), None) or _Newest()
        while len(self._newest) >= _MOST_WIDTHS:
            del self._newest[next(iter(self._newest))]  # the least recently used
        self._newest[camera, width_px, with_body] = slot
        return slot

    async def _frame(
        self, camera: str, after_seq: int | None, with_body: bool
    ) -> tuple[Frame, BodySample | None] | None:
        """The next frame with another number, and the body tracked in it. Polls: at MOST_HZ the frame is usually there."""
        loop = asyncio.get_running_loop()
        until_s = loop.time() + WAIT_S
        while True:
            hub = self._hub()
            frame = hub.newest(camera) if hub is not None else None
            posed = self._body_for(frame) if with_body and frame is not None else None
            frame = frame if posed is None else posed.frames.frames[camera]
            if frame is not None and frame.seq != after_seq:
                return frame, posed
            if loop.time() > until_s:
                return None
            await asyncio.sleep(_LOOK_EVERY_S)

    def _body_for(self, newest: Frame) -> BodySample | None:
        """The newest body, if it has a pose and a recent frame of this camera."""
        body = self._body()
        frame = None if body is None else body.frames.frames.get(newest.camera)
        if body is None or body.body.joints_m is None or frame is None:
            return None
        return body if newest.t_ns - frame.t_ns <= nanoseconds(POSE_AGE_S) else None


def camera_jpeg(frame: Frame, width_px: int) -> Picture | None:
    """A frame with the camera's own JPEG; None where that is unusable: it is missing, too wide, or its header contradicts
    the decoded size."""
    if frame.encoded is None or width_px < frame.size_px[0]:
        return None
    try:
        if not is_plain_jpeg(frame.encoded, frame.size_px):
            return None
    except MalformedError:
        return None
    return Picture(frame.camera, frame.seq, frame.t_ns, frame.size_px, frame.encoded)


def encode(frame: Frame, width_px: int, quality: int = JPEG_QUALITY) -> Picture:
    """A frame as JPEG, at most `width_px` wide."""
    width, height = frame.size_px
    if width_px < width:
        small, _ = frame.small(1 << (width // width_px).bit_length() - 1)
        pixels = _scale(small, width_px, max(1, round(height * width_px / width)))
    else:
        pixels = frame.pixels
    _, jpeg = cv2.imencode(".jpg", pixels, (cv2.IMWRITE_JPEG_QUALITY, quality))
    return Picture(frame.camera, frame.seq, frame.t_ns, (width, height), jpeg.tobytes())


def _scale(pixels: Bytes, width_px: int, height_px: int) -> Bytes:
    """Halves by area averaging (OpenCV's fast path), the rest linearly: 640 to 480 in 1 ms instead of 5."""
    small: object = pixels
    height, width = pixels.shape[:2]
    while width >= 2 * width_px and height >= 2:
        width, height = width // 2, height // 2
        small = cv2.resize(np.asarray(small), (width, height), interpolation=cv2.INTER_AREA)
    small = cv2.resize(np.asarray(small), (width_px, height_px), interpolation=cv2.INTER_LINEAR)
    return np.asarray(small, dtype=np.uint8)
