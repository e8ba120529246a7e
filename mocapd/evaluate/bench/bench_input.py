"""Input of a benchmark: the decoded frame sets of a capture folder or of a simulated scenario."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from mocapd.calibration.calibration_record import Calibration
from mocapd.calibration.from_origin import from_origin
from mocapd.capture.kinds.source_kinds import is_simulated, open_origin
from mocapd.session.tracker_setup import Progress
from mocapd.types import FrameSet

CHUNK = 30  # frame sets decoded at a time; of two 640x480 cameras they take 55 MB


@dataclass(frozen=True, slots=True, eq=False)
class BenchInput:
    """`sets` iterates over the recording of `count` frame sets from its start, decoding lazily."""

    name: str
    calibration: Calibration
    count: int
    sets: Callable[[], Iterable[FrameSet]]

    def chunks(self) -> Iterator[list[FrameSet]]:
        """All frame sets in chunks, each decoded before its use."""
        sets = iter(self.sets())
        while chunk := list(islice(sets, CHUNK)):
            yield chunk


def open_input(source: str, cache_dir: Path, stature_m: float, progress: Progress) -> BenchInput:
    """A capture folder or `sim:SCENARIO`, rendered if it is not in the cache.

    `stature_m` [m] is the default for folders without one. Raises InputError, ConfigError or
    CannotCreateError.
    """
    origin = open_origin(source, cache_dir, progress)
    calibration = from_origin(origin).assuming(stature_m)
    name = source if is_simulated(source) else Path(source).name
    return BenchInput(name, calibration, origin.count, origin.frame_sets)
