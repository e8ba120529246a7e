"""The cameras of a setup by itself: opened, and their pictures in one hub."""

import time
from collections.abc import Callable, Mapping, Sequence

from mocapd.capture.base import Source
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.capture.camera_thread.capture_watchdog import CaptureWatchdog
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.kinds.source_kinds import identities_of, open_source
from mocapd.capture.pace import Pace
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.errors import MocapdError
from mocapd.pipeline.bundler import BundlerParams
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.wizard.draft import DraftCamera

STOP_S = 1.4  # for all threads together to end; a stalled camera takes a second [s]


class OpenCameras:
    """Captures from `start` to `stop`. Trouble with a camera is a state of it, and does not affect the rest.

    `died` gets unexpected exceptions. Used by one thread, except `statuses`.
    """

    def __init__(
        self,
        cameras: Sequence[DraftCamera],
        died: Callable[[BaseException], None],
        sources: Mapping[str, Source] | None = None,
        bundler: BundlerParams | None = None,
    ) -> None:
        """sources: existing ones, by id; bundler: see FrameHub. Raises ConfigError or InputError for an invalid
        source."""
        self.cameras = tuple(cameras)
        self.hub = FrameHub((camera.id for camera in cameras), bundler=bundler)
        self._died = died
        self._pace = Pace(live=True)  # recordings start together and keep their own time
        given = sources or {}
        self.sources = tuple(given.get(camera.id) or self._source(camera) for camera in cameras)
        self._captures = {
            camera.id: self._thread(source, camera)
            for camera, source in zip(cameras, self.sources, strict=True)
        }
        self._care = CaptureWatchdog(self._captures.values())

    def start(self) -> None:
        """Begin; returns at once."""
        for capture in self._captures.values():
            capture.start()

    def watch(self) -> None:
        """Recover stalled cameras: call it several times a second."""
        self._care.watch()

    def statuses(self) -> Mapping[str, CaptureStatus]:
        """The status of each camera, by id; from any thread."""
        return {name: capture.status() for name, capture in self._captures.items()}

    def stop(self) -> None:
        """First signal all threads, then join them."""
        for capture in self._captures.values():
            capture.let_go()
        until_s = time.monotonic() + STOP_S
        for capture in self._captures.values():
            capture.stop(max(0.0, until_s - time.monotonic()))

    def _thread(self, source: Source, camera: DraftCamera) -> CaptureThread:
        expected_hz = None if source.recorded else camera.fps_hz
        return CaptureThread(source, self.hub, self._on_end, expected_hz)

    def _source(self, camera: DraftCamera) -> Source:
        settings = WebcamSettings(camera.size_px, camera.fps_hz, camera.controls)
        others = identities_of(
            (other.id, other.source) for other in self.cameras if other != camera
        )
        request = SourceRequest(
            camera.id, settings=settings, others=tuple(others.values()), pace=self._pace
        )
        return open_source(camera.source, request)

    def _on_end(self, error: BaseException) -> None:
        if not isinstance(error, MocapdError):  # the camera's status has those
            self._died(error)
