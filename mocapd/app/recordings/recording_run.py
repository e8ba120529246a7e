"""Implementation of `mocapd record`: writes the daemon's stream to a file until its end or a signal."""

import time
from functools import partial
from pathlib import Path

import numpy as np

from mocapd.app.daemon.daemon_pictures import DaemonPictures
from mocapd.app.recordings.published import Published, PublishedStream
from mocapd.app.terminal.status_line import StatusLine
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.clock import monotonic_ns
from mocapd.latch import Latch
from mocapd.outputs.mcap.recording_writer import RecordingWriter
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton
from mocapd.types import Camera, Rig

_LOOK_S = 0.1  # poll interval of the end and of the file's flush without frames [s]
_SILENT_S = 2.0  # without frames, before the status line reports it [s]


class Recorder:
    """One recording; `end` is thread-safe and signal-safe."""

    def __init__(
        self,
        stream: PublishedStream,
        writer: RecordingWriter,
        pictures: DaemonPictures | None,
        seconds: float | None,
    ) -> None:
        """pictures: None for frames only; seconds: duration, None: until `end`."""
        self._stream, self._writer, self._pictures = stream, writer, pictures
        self._seconds = seconds
        self._ended = Latch()
        self._calibration: CalibrationInfo | None = None
        self._rest: RestSkeleton | None = None
        self._attached = False
        self._unix_ns = 0  # of the newest frame
        self._seqs: dict[int, int] = {}
        self.missed = 0  # frames lost on the bus

    def end(self) -> None:
        """Makes `run` return."""
        self._ended.set()

    def run(self, line: StatusLine) -> None:
        """Records until the end. Raises CannotCreateError when writing fails."""
        began_s = heard_s = time.monotonic()
        while not self._ended.is_set():
            now_s = time.monotonic()
            if self._seconds is not None and now_s - began_s >= self._seconds:
                return
            received = self._stream.next(_LOOK_S)
            if received is not None:
                heard_s = now_s
                self._write(received)
            if self._pictures is not None:
                self._pictures.drain(self._writer, time.time_ns())
            self._writer.flush_if_due(monotonic_ns())
            line.say(partial(self._text, now_s - began_s, now_s - heard_s))

    def _write(self, received: Published) -> None:
        message = received.message
        if isinstance(message, RestSkeleton | CalibrationInfo):
            if isinstance(message, RestSkeleton):
                self._rest = message
            else:
                self._calibration = message
            self._writer.add_state(message, self._unix_ns or time.time_ns())
            return
        self._unix_ns = message.capture_unix_ns
        if not self._attached:
            self._attached = True
            if self._pictures is None:  # else the daemon sends its metadata
                self._writer.attach(self._metadata(), message.capture_unix_ns)
        self._writer.frame(message, received.payload, received.mime)
        before = self._seqs.get(message.person, message.seq - 1)
        self.missed += max(0, message.seq - before - 1)  # a restarted daemon counts from 0
        self._seqs[message.person] = message.seq

    def _metadata(self) -> RecordingMetadata:
        cameras = self._calibration.cameras if self._calibration is not None else ()
        rig = Rig(
            tuple(
                Camera(
                    camera.name,
                    camera.size_px,
                    np.array(camera.K).reshape(3, 3),
                    np.array(camera.dist),
                    np.array(camera.R).reshape(3, 3),
                    np.array(camera.t_m),
                )
                for camera in cameras
            )
        )
        return RecordingMetadata(
            rig if cameras else None, self._rest.stature_m if self._rest is not None else None
        )

    def _text(self, took_s: float, silent_s: float) -> str:
        """The status line."""
        writer, stream = self._writer, self._stream
        parts = [f"recording {writer.path}", duration(took_s), f"{writer.frames} frames"]
        if self._pictures is not None:
            lost = f" ({self._pictures.dropped} lost)" if self._pictures.dropped else ""
            parts.append(f"{writer.pictures} pictures{lost}")
            parts += [f"no more pictures: {self._pictures.over}"] if self._pictures.over else []
        parts.append(f"{writer.bytes / 1e6:.1f} MB")
        if self.missed:
            parts.append(f"{self.missed} missed")
        if stream.dropped:
            parts.append(f"{stream.dropped} lost: the disk is too slow")
        if stream.refused:
            parts.append(f"{stream.refused} not understood")
        if silent_s > _SILENT_S:
            parts.append(f"no frames for {silent_s:.0f} s")
        return " | ".join(parts)


def duration(seconds: float) -> str:
    """A duration as H:MM:SS."""
    whole = int(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02}:{whole % 60:02}"


def default_path() -> Path:
    """A file name with the local date and time."""
    return Path(time.strftime("mocapd-%Y%m%d-%H%M%S.mcap"))
