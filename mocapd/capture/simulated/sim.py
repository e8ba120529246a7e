"""A simulated webcam: plays a scenario's film at its own pace, with the scenario's faults."""

import threading
from collections.abc import Callable

import numpy as np

from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.clock import monotonic_ns, nanoseconds, seconds
from mocapd.errors import CameraLost, ConfigError, InputError, MalformedError
from mocapd.sim.film import Film
from mocapd.sim.scenario import Scenario
from mocapd.sim.world import is_out
from mocapd.types import Frame


class SimCamera:
    """One camera of a scenario as an ordinary `Source`, which requests its pictures frame by frame.

    Frame n is exposed at epoch_ns + n / fps + the camera's clock offset; with one epoch for all of
    them, the cameras of a scenario show one world without further coordination. As with a webcam
    that buffers a single frame, a reader that is late gets the newest one, and `seq` shows the gap;
    so do frames that the scenario drops. In the scenario's outages `read` raises CameraLost.
    `t_ns` is the middle of the exposure; a frame is handed out when its exposure ends. Decoding happens
    in `read`.
    """

    recorded = False

    def __init__(
        self,
        scenario: Scenario,
        camera: str,
        jpeg: Callable[[int], bytes],
        epoch_ns: int,
        first_shown: int = 0,
        reduced_by: int = 1,
    ) -> None:
        """jpeg: the file that frame n >= 0 comes in; called by `read` when its exposure has ended. first_shown:
        which frame of the world frame 0 shows; reduced_by: see SourceRequest."""
        specs = {spec.name: (i, spec) for i, spec in enumerate(scenario.cameras)}
        if camera not in specs:
            raise ConfigError(
                f"the scenario {scenario.name!r} has no camera {camera!r}",
                "camera",
                f"use one of {sorted(specs)}",
            )
        self.name = camera
        index, self._spec = specs[camera]
        self._jpeg, self._reduced_by = jpeg, reduced_by
        self._scenario, self._first_shown = scenario, first_shown
        self._fps_hz = scenario.fps_hz
        self._seed = (scenario.seed, 7, index)
        self._epoch_ns = epoch_ns
        self._closed = threading.Event()
        self._next: int | None = None
        self._first = 0

    def open(self) -> None:
        """Switch on; the next frame to be exposed is number 0."""
        self._closed.clear()
        self._next = None

    def read(self) -> Frame:
        """The next frame, when its exposure ends. Raises CameraLost once closed, or in an outage."""
        n = self._due(monotonic_ns())
        if self._next is None:
            n = self._first = self._next = max(n + 1, 0)
        n = max(n, self._next)
        while self.drops(n):
            n += 1
        self._next = n + 1
        wait_ns = self._ready_ns(n) - monotonic_ns()
        if self._closed.wait(seconds(max(wait_ns, 0))):
            raise CameraLost("the simulated camera was closed", self.name, "open it again")
        if is_out(self._scenario, self._spec, self._first_shown + n):
            raise CameraLost("was unplugged", self.name, "the scenario plugs it in again")
        jpeg = self._jpeg(n)
        try:
            picture = read_jpeg(jpeg, reduced_by=self._reduced_by)
        except MalformedError as error:
            raise InputError(
                f"a frame of the film {error.what}", self.name, "delete the cache"
            ) from None
        seq, t_ns = n - self._first, self.exposure_ns(n)
        return Frame(self.name, seq, t_ns, picture)

    def close(self) -> None:
        """Switch off and wake a blocked `read`."""
        self._closed.set()

    def exposure_ns(self, n: int) -> int:
        """Middle of the exposure of frame n [ns, CLOCK_MONOTONIC]."""
        return (
            self._epoch_ns + nanoseconds(n / self._fps_hz) + nanoseconds(self._spec.clock_offset_s)
        )

    def drops(self, n: int) -> bool:
        """True if frame n is lost; determined by the scenario's seed."""
        if self._spec.dropped <= 0.0:
            return False
        return bool(np.random.default_rng([*self._seed, n]).uniform() < self._spec.dropped)

    def _ready_ns(self, n: int) -> int:
        return self.exposure_ns(n) + nanoseconds(0.5 * self._spec.shutter_s)

    def _due(self, now_ns: int) -> int:
        """The last frame with a finished exposure."""
        return int((now_ns - self._ready_ns(0)) * self._fps_hz // 1_000_000_000)


class SimSource(SimCamera):
    """One camera of a film, which it shows over and over. Raises ConfigError for an unknown one."""

    def __init__(self, film: Film, camera: str, epoch_ns: int = 0, reduced_by: int = 1) -> None:
        jpegs = film.frames.get(camera, ())
        super().__init__(
            film.scenario, camera, lambda n: jpegs[n % len(jpegs)], epoch_ns, film.first, reduced_by
        )
