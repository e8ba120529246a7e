"""Pictures as JPEG, only when somebody asks, and once for everybody who asks for the same.

What a camera delivers as JPEG is handed on as it is to whoever asks for its whole width."""

import asyncio
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, field

import cv2
import numpy as np

from mocapd.boundary.pictures import is_plain_jpeg
from mocapd.errors import MalformedError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Bytes, Frame
from mocapd.web.links.socket_link import MOST_HZ

NARROWEST_PX, WIDTH_STEP_PX = 64, 32
JPEG_QUALITY = 75
WAIT_S = 1.0  # how long a new frame is waited for [s]
_LOOK_EVERY_S = 0.01
_MOST_WIDTHS = 16  # of one camera that are kept


@dataclass(frozen=True, slots=True)
class Picture:
    """One frame as JPEG. size_px: of the camera's whole frame, not of the JPEG."""

    camera: str
    seq: int
    t_ns: int
    size_px: tuple[int, int]
    jpeg: bytes


@dataclass(slots=True)
class _Newest:
    picture: Picture | None = None
    made_s: float = 0.0
    lock: asyncio.Lock = field(default_factory=asyncio.Lock)


class PictureEncoder:
    """Used within one event loop; encodes in `executor`. `encoded` counts what it has encoded."""

    def __init__(self, hub: Callable[[], FrameHub | None], executor: Executor) -> None:
        self.encoded = 0
        self._hub, self.executor = hub, executor
        self._newest: dict[tuple[str, int], _Newest] = {}

    async def picture(self, camera: str, width_px: int, after_seq: int | None) -> Picture | None:
        """The camera's newest frame, other than the one with `after_seq` that is known already.

        At most `width_px` wide and never wider than the camera's; None when no such frame comes in
        time. No camera and width is encoded more often than MOST_HZ.
        """
        width_px = max(NARROWEST_PX, -(-width_px // WIDTH_STEP_PX) * WIDTH_STEP_PX)
        newest = self._slot(camera, width_px)
        loop = asyncio.get_running_loop()
        async with newest.lock:
            before, due_s = newest.picture, newest.made_s + 1.0 / MOST_HZ
            if before is not None and before.seq != after_seq and loop.time() < due_s:
                return before
            await asyncio.sleep(due_s - loop.time())
            frame = await self._frame(camera, after_seq)
            if frame is None:
                return None
            if before is None or frame.seq != before.seq or frame.t_ns != before.t_ns:
                newest.made_s = loop.time()
                before = delivered(frame, width_px)
                if before is None:
                    before = await loop.run_in_executor(self.executor, encode, frame, width_px)
                    self.encoded += 1
                newest.picture = before
            return before

    def _slot(self, camera: str, width_px: int) -> _Newest:
        found = self._newest.pop((camera, width_px), None) or _Newest()
        while len(self._newest) >= _MOST_WIDTHS:
            del self._newest[next(iter(self._newest))]  # the one that was not asked for the longest
        self._newest[camera, width_px] = found
        return found

    async def _frame(self, camera: str, after_seq: int | None) -> Frame | None:
        """The first frame that is another; looked for, not waited for: at MOST_HZ it is there."""
        loop = asyncio.get_running_loop()
        until_s = loop.time() + WAIT_S
        while True:
            hub = self._hub()
            frame = hub.newest(camera) if hub is not None else None
            if frame is not None and frame.seq != after_seq:
                return frame
            if loop.time() > until_s:
                return None
            await asyncio.sleep(_LOOK_EVERY_S)


def delivered(frame: Frame, width_px: int) -> Picture | None:
    """A frame with the camera's own JPEG; None where that cannot be shown as it is: there is none, fewer
    pixels are wanted, or it says something else of itself than what was decoded from it."""
    height, width = frame.pixels.shape[:2]
    if frame.encoded is None or width_px < width:
        return None
    try:
        if not is_plain_jpeg(frame.encoded, (width, height)):
            return None
    except MalformedError:
        return None
    return Picture(frame.camera, frame.seq, frame.t_ns, (width, height), frame.encoded)


def encode(frame: Frame, width_px: int, quality: int = JPEG_QUALITY) -> Picture:
    """A frame as JPEG, at most so wide."""
    height, width = frame.pixels.shape[:2]
    pixels = frame.pixels
    if width_px < width:
        pixels = _scaled(pixels, width_px, max(1, round(height * width_px / width)))
    _, jpeg = cv2.imencode(".jpg", pixels, (cv2.IMWRITE_JPEG_QUALITY, quality))
    return Picture(frame.camera, frame.seq, frame.t_ns, (width, height), jpeg.tobytes())


def _scaled(pixels: Bytes, width_px: int, height_px: int) -> Bytes:
    """Areas by halves, which has a quick path, the rest linearly: 640 to 480 in 1 ms instead of 5."""
    small: object = pixels
    height, width = pixels.shape[:2]
    while width >= 2 * width_px and height >= 2:
        width, height = width // 2, height // 2
        small = cv2.resize(np.asarray(small), (width, height), interpolation=cv2.INTER_AREA)
    small = cv2.resize(np.asarray(small), (width_px, height_px), interpolation=cv2.INTER_LINEAR)
    return np.asarray(small, dtype=np.uint8)
