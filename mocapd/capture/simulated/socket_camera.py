"""A simulated webcam with plugging and faults; see `sockets`."""

import threading
from collections.abc import Callable
from dataclasses import replace

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2

from mocapd.capture.base import Source
from mocapd.capture.jpeg_picture import JpegPicture, read_jpeg
from mocapd.capture.pixels import frozen_pixels
from mocapd.capture.simulated.sockets import Fault, FoundSocket, Sockets
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.errors import CameraLost, ConfigError, InputError, MalformedError, UnavailableError
from mocapd.types import Frame

_STALL_S = 1.0  # as OpenCV waits for a webcam, see `environment`
_STUCK_S = 0.05


class SocketCamera:
    """A webcam found by identity; it shows the view of the webcam in that socket, even of a wrong one.

    As a real webcam, it is lost at the next picture after unplugging, and cannot be opened twice.
    """

    recorded = False

    def __init__(self, name: str, sockets: Sockets, shown: Callable[[str], Source]) -> None:
        """shown: what the scenario's camera of this name sees."""
        self.name = name
        self.torn = 0
        self._sockets, self._shown = sockets, shown
        self._found: FoundSocket | None = None
        self._camera: Source | None = None
        self._closed = threading.Event()
        self._still: Frame | None = None

    def open(self) -> None:
        """Raises UnavailableError (absent, busy, one of several alike), InputError or ConfigError."""
        self.close()
        socket = self._sockets.find(self.name)
        self._sockets.take(socket.plugged, self)
        self._closed.clear()
        self._found, self._still = socket, None
        self._camera = self._shown(socket.plugged.webcam)
        self._camera.open()

    def read(self) -> Frame:
        """The next whole picture. Raises CameraLost."""
        camera, socket = self._camera, self._found
        if camera is None or socket is None:
            raise CameraLost("is closed", fix="it is opened again by itself")
        while True:
            frame = camera.read()
            picture = self._apply_fault(frame, self._fault(socket))
            if picture is not None:
                return replace(picture, camera=self.name)
            self.torn += 1

    def close(self) -> None:
        self._closed.set()
        socket, camera = self._found, self._camera
        self._found = self._camera = None
        if camera is not None:
            camera.close()
        if socket is not None:
            self._sockets.give_back(socket.plugged, self)

    def plugging(self) -> str:
        """See Pluggable."""
        try:
            socket = self._sockets.find(self.name)
        except (UnavailableError, InputError, ConfigError):
            return ""
        return f"{socket.port} {socket.plugged.webcam} {socket.plugged.plugging}"

    @property
    def identity(self) -> WebcamIdentity:
        """See Pluggable."""
        return self._sockets.identity(self.name)

    @property
    def place(self) -> str:
        """See Pluggable."""
        socket = self._found
        return (
            f"in another USB port than configured ({socket.port})"
            if socket and socket.moved
            else ""
        )

    def _fault(self, socket: FoundSocket) -> Fault:
        """The current fault. Raises CameraLost when unplugged or stalled; blocks during the fault STUCK."""
        now = self._sockets.now().sockets.get(socket.port)
        while now is not None and now.fault is Fault.STUCK:
            threading.Event().wait(_STUCK_S)
            now = self._sockets.now().sockets.get(socket.port)
        if now is None or (now.webcam, now.plugging) != (
            socket.plugged.webcam,
            socket.plugged.plugging,
        ):
            raise CameraLost("was unplugged", fix="plug it in again")
        if now.fault is Fault.STALLED and not self._closed.wait(_STALL_S):
            raise CameraLost(f"sent nothing for {_STALL_S:.1f} s", fix="unplug and replug it")
        return now.fault

    def _apply_fault(self, frame: Frame, fault: Fault) -> Frame | None:
        """The picture with this fault applied; None when it is damaged."""
        if fault is Fault.FROZEN:
            self._still = still = self._still or frame
            return replace(still, seq=frame.seq, t_ns=frame.t_ns)
        self._still = None
        if fault is Fault.BLACK:
            return _with(frame, frame.pixels * 0)
        if fault is Fault.SMALL:
            return _with(frame, cv2.resize(frame.pixels, None, fx=0.5, fy=0.5))
        if fault is Fault.TORN and frame.seq % 2 and frame.encoded is not None:
            return _cut(frame, frame.encoded)
        return frame


def _with(frame: Frame, pixels: cv2.typing.MatLike) -> Frame:
    encoded = cv2.imencode(".jpg", pixels)[1].tobytes()
    return replace(frame, picture=JpegPicture(encoded, frozen_pixels(pixels)))


def _cut(frame: Frame, encoded: bytes) -> Frame | None:
    try:
        return replace(frame, picture=read_jpeg(encoded[: len(encoded) // 2]))
    except MalformedError:
        return None
