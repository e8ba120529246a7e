"""From what arrived to a Frame: the stamp believed only so far, the picture measured before it is decoded."""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

from dataclasses import dataclass

from mocapd.boundary.pictures import decode_camera_picture
from mocapd.capture.pixels import frozen_pixels
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import PictureStamp
from mocapd.capture.remote.clock_fit import ClockLine
from mocapd.clock import NS_PER_S
from mocapd.errors import MalformedError
from mocapd.types import Frame

_OLDEST_NS = NS_PER_S  # an exposure longer ago than this, or so far ahead, is of another clock


@dataclass(frozen=True, slots=True)
class Arrived:
    """A picture as it came, not looked into yet: the file, its stamp, and when it came [ns, CLOCK_MONOTONIC]."""

    data: bytes
    stamp: bytes
    came_ns: int


class PictureReader:
    """The pictures of one camera, in the order in which they came."""

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._last_ns = 0

    def read(
        self, arrived: Arrived, size_px: tuple[int, int], run: int | None, clock: ClockLine | None
    ) -> Frame:
        """size_px: (width, height) that it must have; run, clock: of its node. Raises MalformedError, also for one
        of a node that was started anew and whose clock is not known yet."""
        stamp = camera_wire.decode(arrived.stamp, PictureStamp)
        if clock is None or stamp.run != run:
            raise MalformedError("is of another run of its node")
        t_ns = clock.local_from_remote(stamp.exposure_ns)
        if abs(t_ns - arrived.came_ns) > _OLDEST_NS:
            raise MalformedError("was exposed at a time that cannot be")
        pixels = frozen_pixels(decode_camera_picture(arrived.data, size_px))
        # no picture is exposed after it came, nor before the one before it: the rest of the clock's error
        t_ns = max(min(t_ns, arrived.came_ns), self._last_ns + 1)
        self._last_ns = t_ns
        return Frame(self._camera, stamp.seq, t_ns, pixels, arrived.data)
