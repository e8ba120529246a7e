"""A scenario's film as the origin of simulated webcams: their pictures, rig and calibration."""

import logging
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path

from mocapd.capture.base import Source
from mocapd.capture.file import check_size
from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.capture.origin import Progress, split_address
from mocapd.capture.simulated.sim import SimSource
from mocapd.capture.simulated.socket_camera import SocketCamera
from mocapd.capture.simulated.sockets import Sockets
from mocapd.capture.source_request import SourceRequest
from mocapd.clock import monotonic_ns, nanoseconds
from mocapd.sim.film import Film, film_key, load_beginning, load_film
from mocapd.sim.scenario import Scenario
from mocapd.sim.world import is_out
from mocapd.types import Frame, FrameSet, LabelledPicture, Rig

_LOG = logging.getLogger(__name__)


class FilmOrigin:
    """See Origin. Its cameras share one start time, at the first opening. With `sockets` they can be unplugged."""

    def __init__(self, address: str, film: Film, sockets: Sockets | None = None) -> None:
        self.rig_source = address
        self._sockets = sockets
        self._film = film
        self._start = _FilmStart(film.scenario, film.first)

    @property
    def rig(self) -> Rig:
        return self._film.setup.rig

    @property
    def stature_m(self) -> float | None:
        return self._film.setup.stature_m

    @property
    def fps_hz(self) -> float:
        return self._film.scenario.fps_hz

    @property
    def count(self) -> int:
        return min(len(jpegs) for jpegs in self._film.frames.values())

    def model(self) -> tuple[LabelledPicture, ...]:
        return self._film.setup.model

    def white_balance(self) -> Mapping[str, LabelledPicture]:
        return self._film.setup.scribbles

    def frame_sets(self) -> Iterator[FrameSet]:
        """See Origin. One loop, as the bundler would pair it: each frame at its camera's own time."""
        scenario = self._film.scenario
        for i in range(self.count):
            frames = {
                spec.name: self._frame(spec.name, i, spec.clock_offset_s)
                for spec in scenario.cameras
                if not is_out(scenario, spec, self._film.first + i)
            }
            if not frames:
                continue
            times_ns = [frame.t_ns for frame in frames.values()]
            yield FrameSet(max(times_ns), frames, max(times_ns) - min(times_ns))

    def source(self, address: str, request: SourceRequest) -> Source:
        """See Origin. A camera's id is its name in the scenario, which has the rig."""
        name = request.name or split_address(address)[1]
        camera = self._camera(name, request.reduced_by)
        (size_px,) = (spec.size_px for spec in self.rig.cameras if spec.name == name)
        check_size(self.rig_source, name, size_px, request.size_px)
        return camera

    def _camera(self, name: str, reduced_by: int) -> Source:
        def shown(webcam: str) -> Source:
            return _FilmCamera(self._start, self._film, webcam, reduced_by)

        return shown(name) if self._sockets is None else SocketCamera(name, self._sockets, shown)

    def _frame(self, camera: str, i: int, clock_offset_s: float) -> Frame:
        jpeg = self._film.frames[camera][i]
        return Frame(camera, i, nanoseconds(i / self.fps_hz + clock_offset_s), read_jpeg(jpeg))


class _FilmStart:
    """Shared by the cameras, which outlive the origin and its pictures; from any thread."""

    def __init__(self, scenario: Scenario, first: int) -> None:
        self._scenario, self._first = scenario, first
        self._lock = threading.Lock()
        self._ns: int | None = None

    def ns(self) -> int:
        """When frame 0 of the film is exposed: now, the first time [ns, CLOCK_MONOTONIC]."""
        with self._lock:
            if self._ns is None:
                self._ns = monotonic_ns()
                # lets a test compute the simulated person's pose at any time
                _LOG.info(
                    "frame %d of the film %r is at %d ns of the monotonic clock, at %g Hz",
                    *(self._first, self._scenario.name, self._ns, self._scenario.fps_hz),
                )
            return self._ns


class _FilmCamera(SimSource):
    def __init__(self, start: _FilmStart, film: Film, camera: str, reduced_by: int) -> None:
        super().__init__(film, camera, reduced_by=reduced_by)
        self._start = start

    def open(self) -> None:
        self._epoch_ns = self._start.ns()
        super().open()


def open_film(
    address: str,
    scenario: Scenario,
    cache_dir: Path,
    progress: Progress,
    sockets: Sockets | None = None,
    is_beginning: bool = False,
) -> FilmOrigin:
    """The scenario's film, or the beginning of it, rendered when it is not in the cache. Raises MocapdError."""
    what = "rendering the simulated webcams"
    if not any(cache_dir.glob(f"*{film_key(scenario)[:16]}*")):
        progress(what, 0, 1)  # something to see while the renderer is compiled
    load = load_beginning if is_beginning else load_film
    film = load(scenario, cache_dir, lambda done, total: progress(what, done, total))
    return FilmOrigin(address, film, sockets)
