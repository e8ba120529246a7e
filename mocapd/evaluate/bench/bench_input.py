"""What a benchmark runs on: the frame sets of a capture folder or of a simulated scenario, decoded."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import cv2
import numpy as np

from mocapd.calibration.from_capture import from_capture
from mocapd.calibration.record import Calibration
from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.clock import nanoseconds
from mocapd.session import simulation
from mocapd.session.tracker_setup import Progress
from mocapd.sim.film import Film
from mocapd.types import Frame, FrameSet

CHUNK = 30  # frame sets decoded at a time; of two 640x480 cameras they take 55 MB


@dataclass(frozen=True, slots=True, eq=False)
class BenchInput:
    """`sets` begins the recording of `count` sets anew each time, and decodes as it is read."""

    name: str
    known: Calibration
    count: int
    sets: Callable[[], Iterable[FrameSet]]

    def chunks(self) -> Iterator[list[FrameSet]]:
        """All frame sets, so many at a time that decoding is over before they are used."""
        sets = iter(self.sets())
        while chunk := list(islice(sets, CHUNK)):
            yield chunk


def open_input(source: str, cache_dir: Path, stature_m: float, progress: Progress) -> BenchInput:
    """A capture folder or `sim:SCENARIO`, whose film is rendered when it is not in the cache.

    `stature_m` [m] is for folders that do not say. Raises InputError, ConfigError or
    CannotCreateError.
    """
    if source.startswith(simulation.SIM):
        film = simulation.open_film(source, cache_dir, progress)
        known = simulation.from_scenario(film.setup)
        return BenchInput(source, known, _film_length(film), lambda: _film_sets(film))
    folder = load_folder(Path(source))
    known = from_capture(folder).assuming(stature_m)
    count = max(camera.frames for camera in folder.cameras)
    return BenchInput(folder.path.name, known, count, lambda: frame_sets(folder))


def _film_sets(film: Film) -> Iterator[FrameSet]:
    """One loop, as the bundler would pair it: each frame at its camera's own time."""
    for i in range(_film_length(film)):
        frames = {
            spec.name: _film_frame(film, spec.name, i, spec.clock_offset_s)
            for spec in film.scenario.cameras
        }
        times_ns = [frame.t_ns for frame in frames.values()]
        yield FrameSet(max(times_ns), frames, max(times_ns) - min(times_ns))


def _film_length(film: Film) -> int:
    return min(len(jpegs) for jpegs in film.frames.values())


def _film_frame(film: Film, camera: str, i: int, clock_offset_s: float) -> Frame:
    data = np.frombuffer(film.frames[camera][i], dtype=np.uint8)
    pixels = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.uint8)
    pixels.setflags(write=False)
    return Frame(camera, i, nanoseconds(i / film.scenario.fps_hz + clock_offset_s), pixels)
