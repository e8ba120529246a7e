"""One camera of a recording: decodes its JPEGs at their recorded times."""

import logging
import threading
from collections.abc import Iterator
from pathlib import Path

from mocapd.boundary.mcap_records import McapFile, McapMessage
from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.capture.pace import Pace
from mocapd.capture.recording.recorded_picture import IMAGE, camera_of, decode_picture_message
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import CameraLost, EndOfStream, MalformedError
from mocapd.types import Camera, Frame, Rig

_log = logging.getLogger(__name__)
_LATE_NS = NS_PER_S // 30  # live: later pictures are skipped, as a webcam would


def is_picture(topic: str, schema: str) -> bool:
    """True if a channel of this topic and schema holds a camera's pictures."""
    return schema == IMAGE and bool(camera_of(topic))


class McapSource:
    """See Source. Frame times are those of the recording since its first picture, on the pace's clock."""

    recorded = True

    def __init__(self, name: str, path: Path, camera: Camera, start_ns: int, pace: Pace) -> None:
        """start_ns: when the recording's first picture was taken, Unix time."""
        self.name, self._path, self._camera = name, path, camera
        self._start_ns, self._pace = start_ns, pace
        self._messages: Iterator[McapMessage] | None = None
        self._closed = threading.Event()
        self.torn = 0

    def open(self) -> None:
        self._closed.clear()
        self._messages = _picture_messages(self._path, self._camera.name)

    def read(self) -> Frame:
        """See Source. A picture that does not decode is left out and counted in `torn`."""
        messages = self._messages
        if messages is None:
            raise CameraLost("not open", self.name, "call open first")
        for message in messages:
            if self._closed.is_set():
                raise CameraLost("closed", self.name)
            t_ns = self._pace.start_ns() + message.log_ns - self._start_ns
            if self._pace.live:
                wait_ns = t_ns - monotonic_ns()
                if wait_ns < -_LATE_NS:
                    continue
                if self._closed.wait(max(0, wait_ns) / NS_PER_S):
                    raise CameraLost("closed while reading", self.name)
            frame = _frame(message, self._camera, self.name, t_ns)
            if frame is not None:
                return frame
            self.torn += 1
        raise EndOfStream("ended after all of its pictures", str(self._path))

    def close(self) -> None:
        self._closed.set()


def pictures(path: Path, rig: Rig, start_ns: int) -> Iterator[Frame]:
    """Every picture of every camera by its time since `start_ns`, as fast as they decode."""
    cameras = {camera.name: camera for camera in rig.cameras}
    for message in _picture_messages(path, ""):
        name = camera_of(message.topic)
        frame = _frame(message, cameras[name], name, message.log_ns - start_ns)
        if frame is not None:
            yield frame


def _picture_messages(path: Path, camera: str) -> Iterator[McapMessage]:
    """The picture messages of one camera, or of all when empty; logs an early end of the file."""
    file = McapFile(path)

    def is_wanted(topic: str, schema: str) -> bool:
        return is_picture(topic, schema) and camera in ("", camera_of(topic))

    for item in file.items(is_wanted):
        if isinstance(item, McapMessage):
            yield item
    if file.ending:
        _log.warning("%s: %s; what came before is used", path, file.ending)


def _frame(message: McapMessage, camera: Camera, name: str, t_ns: int) -> Frame | None:
    """None for a picture that is damaged or of another size than its calibration."""
    try:
        jpeg = decode_picture_message(message.data).data
        picture = read_jpeg(jpeg, camera.size_px)
    except MalformedError as error:
        _log.warning("a picture of camera %r is left out: it %s", camera.name, error.what)
        return None
    return Frame(name, message.sequence, t_ns, picture)
