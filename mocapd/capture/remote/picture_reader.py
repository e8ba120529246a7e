"""Converts a received picture to a Frame: checks the stamp, and the picture's size before decoding."""

from dataclasses import dataclass

from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import PictureStamp
from mocapd.capture.remote.clock_fit import ClockLine
from mocapd.clock import NS_PER_S
from mocapd.errors import MalformedError
from mocapd.types import Frame

_OLDEST_NS = NS_PER_S  # an exposure longer ago than this, or so far ahead, is of another clock


@dataclass(frozen=True, slots=True)
class Arrived:
    """A received picture, not parsed yet: file, stamp, and arrival time [ns, CLOCK_MONOTONIC]."""

    data: bytes
    stamp: bytes
    came_ns: int


class PictureReader:
    """The pictures of one camera, in the order in which they came."""

    def __init__(self, camera: str, reduced_by: int = 1) -> None:
        """reduced_by: see SourceRequest."""
        self._camera, self._reduced_by = camera, reduced_by
        self._last_ns = 0

    def read(
        self, arrived: Arrived, size_px: tuple[int, int], run: int | None, clock: ClockLine | None
    ) -> Frame:
        """size_px: required (width, height); run, clock: of its node. Raises MalformedError, also after a restart of the
        node until its clock is estimated."""
        stamp = camera_wire.decode(arrived.stamp, PictureStamp)
        if clock is None or stamp.run != run:
            raise MalformedError("is of another run of its node")
        t_ns = clock.local_from_remote(stamp.exposure_ns)
        if abs(t_ns - arrived.came_ns) > _OLDEST_NS:
            raise MalformedError("was exposed at a time that cannot be")
        picture = read_jpeg(arrived.data, size_px, self._reduced_by)
        # clip the clock's error: an exposure precedes its arrival and follows the previous exposure
        t_ns = max(min(t_ns, arrived.came_ns), self._last_ns + 1)
        self._last_ns = t_ns
        return Frame(self._camera, stamp.seq, t_ns, picture)
