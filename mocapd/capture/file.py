"""A video file as a camera: at its own pace when played live, as fast as it decodes offline."""

import math
import threading
from dataclasses import dataclass
from pathlib import Path

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2

from mocapd.boundary.files import is_file
from mocapd.boundary.image_decoding import MOST_PIXELS
from mocapd.capture.guard import GuardedCapture
from mocapd.capture.pace import Pace
from mocapd.capture.pixels import frozen_pixels
from mocapd.capture.video_codec import conversion, undecodable_codec
from mocapd.capture.video_container import require_video
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import CameraLost, ConfigError, EndOfStream, InputError
from mocapd.types import Frame

_SKIPPING_NS = 100_000_000  # in one read; bounds the skipping where decoding is slower than playing
_MOST_MISSES = 60  # frames in a row that do not decode, before the file counts as ended
_LONGEST_GAP_S = (
    60.0  # between two frames, as the file stamps them; a longer one is no gap but damage
)
_MOST_FRAMES = 10**8  # a month and more; a file that announces more does not know

# What a file may say of its rate; at the lowest and for the longest film a time still fits its 64 bits.
SLOWEST_HZ, FASTEST_HZ = 0.01, 1000.0


@dataclass(frozen=True, slots=True)
class VideoInfo:
    """The header of a video file; `frames` is 0 where the format has no count."""

    size_px: tuple[int, int]  # width, height
    fps_hz: float
    frames: int


def probe_video(path: Path) -> VideoInfo:
    """Size, rate and length of a video. Raises InputError when it is missing, damaged or empty, or its
    pictures are larger than any camera's."""
    capture = _open(path)
    try:
        info = _info(capture)
        width, height = info.size_px
        if width * height > MOST_PIXELS:  # asked before anything is decoded
            raise InputError(
                f"the pictures are {width}x{height}, at most {MOST_PIXELS} pixels are read",
                str(path),
                "convert the video to a smaller size",
            )
        if not capture.grab():
            codec = undecodable_codec(capture)
            if codec:
                raise InputError(f"{codec} cannot be read here", str(path), conversion(path))
            raise InputError(
                "the video holds no frame that can be decoded", str(path), "record it again"
            )
        return info
    finally:
        capture.release()


def _open(path: Path) -> cv2.VideoCapture:
    if not is_file(path):
        raise InputError("no such video file", str(path), "check the path")
    require_video(path)
    # One decoding thread: the library's pool costs more than it gives at these sizes.
    # Absolute: a name such as concat:x would be a protocol to FFmpeg.
    capture = cv2.VideoCapture(str(path.absolute()), cv2.CAP_FFMPEG, [cv2.CAP_PROP_N_THREADS, 1])
    if not capture.isOpened():
        capture.release()
        raise InputError(
            "not a video, or damaged: its header cannot be read",
            str(path),
            "check that the recording was closed properly, or convert it with ffmpeg",
        )
    return capture


def _info(capture: cv2.VideoCapture) -> VideoInfo:
    size = (int(capture.get(cv2.CAP_PROP_FRAME_WIDTH)), int(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)))
    fps_hz = capture.get(cv2.CAP_PROP_FPS)
    frames = capture.get(cv2.CAP_PROP_FRAME_COUNT)
    return VideoInfo(
        size,
        fps_hz if SLOWEST_HZ <= fps_hz <= FASTEST_HZ else 30.0,
        int(frames) if 0 < frames <= _MOST_FRAMES else 0,
    )


class FileSource:
    """Frame f of the file has time start + f / fps + offset; where the file's rate varies (`stamped`), its own stamp
    since the first frame in place of f / fps.

    `fps_hz` None takes the file's rate. `size_px` (width, height), when given, must be the
    video's. `pace` is shared by files that belong together; None reads offline, from time 0. Live,
    a reader that falls behind by more than a frame skips to the frame that is due, as a webcam
    would: `seq` is the index in the file, so the gap shows.
    """

    recorded = True

    def __init__(
        self,
        name: str,
        path: Path,
        fps_hz: float | None = None,
        time_offset_s: float = 0.0,
        pace: Pace | None = None,
        size_px: tuple[int, int] | None = None,
        stamped: bool = False,
    ) -> None:
        self.name = name
        self.path = path
        self._asked_fps_hz, self._stamped = fps_hz, stamped
        self._offset_ns = round(time_offset_s * NS_PER_S)
        self._pace = pace if pace is not None else Pace(live=False)
        self._size_px = size_px
        self._fps_hz = self._file_fps_hz = fps_hz or 30.0
        self._frames = 0  # as the file announces them; 0 where it does not
        self._index = -1  # of the newest frame
        self._file_ms = self._first_ms = (
            0.0  # its time by the file's own stamp, and the first one's
        )
        self.torn = 0
        self._capture: GuardedCapture | None = None
        self._closed = threading.Event()

    @property
    def fps_hz(self) -> float:
        """The rate by which frames are timed; once it is open."""
        return self._fps_hz

    def open(self) -> None:
        """Raises InputError (missing, damaged) or ConfigError (another size than its calibration)."""
        self.close()
        info = probe_video(self.path)
        check_size(str(self.path), self.name, info.size_px, self._size_px)
        self._fps_hz = self._asked_fps_hz or info.fps_hz
        self._frames = info.frames
        self._file_fps_hz = info.fps_hz
        self._index = -1
        self._closed.clear()
        self._capture = GuardedCapture(_open(self.path))

    def read(self) -> Frame:
        """The next frame, or the one that is due. Raises EndOfStream with the count of frames.

        A frame that does not decode is left out and counted in `torn`; those after it keep their
        index and time.
        """
        guarded = self._capture
        if guarded is None:
            raise CameraLost("not open", self.name, "call open first")
        with guarded as capture:
            if guarded.closing:
                raise CameraLost("closed", self.name)
            self._grab(capture)
            if self._pace.live:
                until_ns = monotonic_ns() + _SKIPPING_NS
                while self._due_ns(self._index + 1) < monotonic_ns() < until_ns:
                    self._grab(capture)
                wait_ns = self._due_ns(self._index) - monotonic_ns()
                if self._closed.wait(max(0, wait_ns) / NS_PER_S):
                    raise CameraLost("closed while reading", self.name)
            _, pixels = capture.retrieve()
        return Frame(self.name, self._index, self._due_ns(self._index), frozen_pixels(pixels))

    def close(self) -> None:
        """Wakes a waiting `read`, which then raises CameraLost."""
        self._closed.set()
        if self._capture is not None:
            self._capture.close()

    def _due_ns(self, index: int) -> int:
        """The time of the newest frame, or of one after it."""
        if self._stamped and self._index >= 0:
            after_ns = round((index - self._index) * NS_PER_S / self._fps_hz)
            own_ns = round((self._file_ms - self._first_ms) * 1e6) + after_ns
        else:
            own_ns = round(index * NS_PER_S / self._fps_hz)
        return self._pace.start_ns() + own_ns + self._offset_ns

    def _grab(self, capture: cv2.VideoCapture) -> None:
        """Step to the next frame that decodes. Damaged ones show as a gap in the file's own time."""
        for _ in range(_MOST_MISSES):
            if capture.grab():
                file_ms = capture.get(cv2.CAP_PROP_POS_MSEC)
                gap_s = (file_ms - self._file_ms) * 1e-3
                believed = self._index >= 0 and math.isfinite(gap_s) and gap_s < _LONGEST_GAP_S
                believed = believed and not self._stamped  # there a gap is no damage
                step = max(1, round(gap_s * self._file_fps_hz)) if believed else 1
                self.torn += step - 1
                self._index += step
                self._file_ms = file_ms
                if self._index == 0:
                    self._first_ms = file_ms
                return
            if self._index + 1 >= self._frames:
                break
        raise self._end()

    def _end(self) -> EndOfStream:
        came = self._index + 1
        if came + 1 < self._frames:  # one frame too many is the rounding of some headers
            return EndOfStream(
                f"ended after {came} of the {self._frames} frames it announces",
                str(self.path),
                "the file is cut short or damaged there; what came before was used",
            )
        return EndOfStream(f"ended after all of its {came} frames", str(self.path))


def size_error(
    where: str, camera: str, got_px: tuple[int, int], want_px: tuple[int, int]
) -> ConfigError:
    """The error of a picture that does not fit the calibration, naming both sizes."""
    return ConfigError(
        f"the pictures are {got_px[0]}x{got_px[1]}, but camera {camera!r} was calibrated at "
        f"{want_px[0]}x{want_px[1]}",
        where,
        f"record or set the camera to {want_px[0]}x{want_px[1]}, or calibrate it again",
    )


def check_size(
    where: str, camera: str, got_px: tuple[int, int], want_px: tuple[int, int] | None
) -> None:
    """Raises ConfigError for pictures that do not fit the calibration; None fits all."""
    if want_px is not None and got_px != want_px:
        raise size_error(where, camera, got_px, want_px)
