"""Records the bodies of a running service to a file, for the page's Record button; `mocapd record` is independent."""

import contextlib
import queue
import threading
import time
from pathlib import Path
from typing import Self

from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.clock import monotonic_ns, unix_from_monotonic_ns
from mocapd.errors import CannotCreateError
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import is_noticeable, rest_skeleton
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.pipeline.body_hub import BodyHub, BodySample
from mocapd.tracking.base import Track
from mocapd.types import FrameSet, Skeleton

_MOST_WAITING = 600  # queued bodies, ten seconds at 60 Hz; beyond that a slow disk loses the newest
_LOOK_S = 0.1


class BodyRecorder:
    """Records from `__enter__` to `__exit__`; the properties are thread-safe."""

    def __init__(
        self, bodies: BodyHub, path: Path, metadata: RecordingMetadata, instance: str
    ) -> None:
        """Creates the file, readable by its owner only. Raises CannotCreateError."""
        self._bodies, self._metadata, self._instance = bodies, metadata, instance
        self._writer = RecordingWriter(path, RecordingParams(private=True), monotonic_ns())
        self._waiting: queue.Queue[BodySample] = queue.Queue(_MOST_WAITING)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page-recording", daemon=True)
        self._began_s = time.monotonic()
        self._ended_s: float | None = None
        self._skeleton: Skeleton | None = None  # the last one written
        self._seq = 0
        self.lost = 0  # bodies dropped because of a slow disk
        self.error: CannotCreateError | None = None  # why writing has stopped

    def __enter__(self) -> Self:
        self._thread.start()
        self._bodies.join(self)
        return self

    def __exit__(self, *_: object) -> None:
        self._bodies.leave(self)
        self._stop_time()
        self._over.set()
        self._thread.join()

    def put(self, sample: BodySample) -> None:
        """See TakesBodies."""
        # without the pictures: a slow or full disk would hold gigabytes of them
        track, t_ns = Track(sample.track.body, sample.track.shape), sample.frames.t_ns
        try:
            self._waiting.put_nowait(BodySample(track, sample.skeleton, FrameSet(t_ns, {})))
        except queue.Full:
            self.lost += 1

    @property
    def trouble(self) -> str:
        """Why frames are missing, for users; empty when none is."""
        if self.error is not None:
            return str(self.error)
        return f"{self.lost} frames are lost: the disk is too slow" if self.lost else ""

    @property
    def path(self) -> Path:
        return self._writer.path

    @property
    def frames(self) -> int:
        """Written so far."""
        return self._writer.frames

    @property
    def length_s(self) -> float:
        """Since it began, until its end or until it could not be written any further [s]."""
        return (self._ended_s or time.monotonic()) - self._began_s

    def _stop_time(self) -> None:
        self._ended_s = self._ended_s or time.monotonic()

    def _run(self) -> None:
        try:
            with self._writer:
                self._writer.attach(self._metadata, time.time_ns())
                while not (self._over.is_set() and self._waiting.empty()):
                    with contextlib.suppress(queue.Empty):
                        self._write(self._waiting.get(timeout=_LOOK_S))
                    self._writer.flush_if_due(monotonic_ns())
        except CannotCreateError as error:
            self._stop_time()
            self.error = error

    def _write(self, sample: BodySample) -> None:
        now_ns, unix_ns = monotonic_ns(), unix_from_monotonic_ns()
        if self._skeleton is None or is_noticeable(self._skeleton, sample.skeleton):
            self._skeleton = sample.skeleton
            stature_m = sample.track.shape.stature_m
            rest = rest_skeleton(sample.skeleton, instance=self._instance, stature_m=stature_m)
            self._writer.add_state(rest, sample.body.t_ns + unix_ns)
        frame = skeleton_frame(
            sample.body,
            sample.skeleton,
            instance=self._instance,
            seq=self._seq,
            publish_monotonic_ns=now_ns,
            unix_from_monotonic_ns=unix_ns,
        )
        self._seq += 1
        self._writer.frame(frame)
