"""A network camera: an RTSP or HTTP URL through OpenCV's FFmpeg."""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2

from mocapd.boundary.image_decoding import MOST_PIXELS
from mocapd.boundary.urls import split_url, without_password
from mocapd.capture.file import size_error
from mocapd.capture.guard import Openings
from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.capture.pixels import frozen_pixels
from mocapd.capture.video_codec import undecodable_codec
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import CameraLost, ConfigError, MalformedError, UnavailableError
from mocapd.types import Frame

_TORN_LIMIT_NS = 2 * NS_PER_S  # without one whole picture: the network is bad
_MJPG = cv2.VideoWriter.fourcc(*"MJPG")


class UrlSource:
    """Frames are stamped on arrival, without the network's delay; so prefer wired cameras.

    `size_px` (width, height), when given, must be what the camera sends. Motion JPEG is decoded here, as other parts use
    the files; `torn` counts damaged ones. Messages hide the password. Raises ConfigError for an invalid address.
    """

    recorded = False

    def __init__(
        self,
        name: str,
        url: str,
        size_px: tuple[int, int] | None = None,
        open_timeout_s: float = 3.0,
        read_timeout_s: float = 1.0,
        reduced_by: int = 1,
    ) -> None:
        """reduced_by: see SourceRequest."""
        if split_url(url).hostname is None:
            raise ConfigError(
                "an address without a host", name, "write it as rtsp://user:password@host:port/path"
            )
        self.name = name
        self._url = url
        self._shown = without_password(url)
        self._size_px, self._reduced_by = size_px, reduced_by
        self._timeouts_ms = (round(1e3 * open_timeout_s), round(1e3 * read_timeout_s))
        self.torn = 0
        self._seq = 0
        self._is_mjpg = False
        self._came = False  # a frame since it was opened
        self._openings = Openings()

    def open(self) -> None:
        """Raises UnavailableError, or ConfigError for another size than its calibration."""
        number = self._openings.begin()
        self._came = False
        open_ms, read_ms = self._timeouts_ms
        capture = cv2.VideoCapture(
            self._url,
            cv2.CAP_FFMPEG,
            [
                cv2.CAP_PROP_OPEN_TIMEOUT_MSEC,
                open_ms,
                cv2.CAP_PROP_READ_TIMEOUT_MSEC,
                read_ms,
                cv2.CAP_PROP_N_THREADS,
                1,
            ],
        )
        if not capture.isOpened():
            capture.release()
            raise UnavailableError(
                f"the network camera does not answer within {open_ms / 1e3:g} s, or sends no video",
                self._shown,
                "check that it is on, and the address, user and password",
            )
        size_px = (
            int(capture.get(cv2.CAP_PROP_FRAME_WIDTH)),
            int(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)),
        )
        if not 0 < size_px[0] * size_px[1] <= MOST_PIXELS:
            capture.release()
            raise UnavailableError(
                f"the network camera sends pictures of {size_px[0]}x{size_px[1]}",
                self._shown,
                "set it to a smaller size",
            )
        if self._size_px is not None and size_px != self._size_px:
            capture.release()
            raise size_error(self._shown, self.name, size_px, self._size_px)
        is_mjpg = int(capture.get(cv2.CAP_PROP_FOURCC)) == _MJPG
        self._is_mjpg = is_mjpg and capture.set(cv2.CAP_PROP_FORMAT, -1)  # files, not pixels
        if not self._openings.take(number, capture):
            raise CameraLost(
                "was closed while it was opened", self._shown, "it is opened again by itself"
            )

    def read(self) -> Frame:
        """Raises CameraLost when nothing came within the read timeout, only damage did, or the stream
        ended."""
        guarded = self._openings.current
        if guarded is None:
            raise CameraLost("is closed", self._shown, "it is opened again by itself")
        began_ns = monotonic_ns()
        codec = ""
        while True:
            with guarded as capture:
                grabbed = not guarded.closing and capture.grab()
                t_ns = monotonic_ns()
                good, raw = capture.retrieve() if grabbed else (False, None)
                if not good and not guarded.closing and not self._came:
                    codec = undecodable_codec(capture)
            if not good or raw is None:
                break
            self._came = True
            seq, self._seq = self._seq, self._seq + 1
            if not self._is_mjpg:
                return Frame(self.name, seq, t_ns, frozen_pixels(raw))
            try:
                picture = read_jpeg(frozen_pixels(raw), reduced_by=self._reduced_by)
            except MalformedError:
                self.torn += 1
                if t_ns - began_ns < _TORN_LIMIT_NS:
                    continue
                break
            return Frame(self.name, seq, t_ns, picture)
        guarded.close()
        if codec:
            raise CameraLost(
                f"the network camera sends {codec}, which cannot be read here",
                self._shown,
                "set it to H.264 or Motion JPEG",
            )
        raise CameraLost("the network camera stopped sending", self._shown, "check its network")

    def close(self) -> None:
        """Closes the stream; a blocked `read` ends after its timeout at the latest."""
        self._openings.close()
