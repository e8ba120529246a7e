"""Cameras under a test's thumb, for a daemon in the test's own process."""

import threading
from dataclasses import dataclass, field
from pathlib import Path

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.capture.file import size_error
from mocapd.clock import monotonic_ns
from mocapd.config.sections import Config
from mocapd.errors import CameraLost, ConfigError
from mocapd.outputs.output_table import OscSection
from mocapd.service.service import Service
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track
from mocapd.types import Frame, FrameSet
from tests.capture.films import SIZE_PX, picture

PERIOD_S = 1.0 / 60.0


@dataclass(eq=False)
class FakeCamera:
    """Sends pictures of `size_px` at 60 Hz. `frozen`: its reads block; `unplugged`: they fail, and so does opening it
    anew; `other_size`: after that it is there again, but does not fit its calibration."""

    name: str
    recorded: bool = False
    size_px: tuple[int, int] = SIZE_PX
    frozen: threading.Event = field(default_factory=threading.Event)
    unplugged: threading.Event = field(default_factory=threading.Event)
    other_size: threading.Event = field(default_factory=threading.Event)
    _closed: threading.Event = field(default_factory=threading.Event)
    _seq: int = 0

    def open(self) -> None:
        self._closed.clear()
        if self.other_size.is_set():
            raise size_error("test", self.name, (320, 240), SIZE_PX)
        if self.unplugged.is_set():
            raise CameraLost("is not there", self.name)

    def read(self) -> Frame:
        self._closed.wait(PERIOD_S)
        while self.frozen.is_set() and not self._closed.wait(0.01):
            pass
        if self._closed.is_set() or self.unplugged.is_set():
            raise CameraLost("was unplugged", self.name)
        self._seq += 1
        pixels = picture(self._seq % 256, self.size_px)
        return Frame(self.name, self._seq, monotonic_ns(), pixels)

    def close(self) -> None:
        self._closed.set()

    @property
    def closed(self) -> bool:
        """Whether it was let go."""
        return self._closed.is_set()


def daemon_on(*cameras: FakeCamera, osc_port: int) -> Service:
    """With a tracker of its own pose, sending OSC to this port of 127.0.0.1; the caller enters it."""
    config = Config(
        outputs={"osc": OscSection(destinations=(f"127.0.0.1:{osc_port}",))},
        state_dir=Path("/nonexistent"),
    )
    inputs = tuple(CameraInput(camera, "test", SIZE_PX) for camera in cameras)
    return Service(config, Session(inputs, None, "", StrictTracker(), mean_shape(1.75)))


class StrictTracker(CannedTracker):
    """The canned one, which looks at no picture, as particular about sizes as the one that does."""

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        for frame in frames.frames.values():
            if frame.pixels.shape[1::-1] != SIZE_PX:
                raise ConfigError("does not fit its calibration", frame.camera)
        return super().step(frames, shape)
