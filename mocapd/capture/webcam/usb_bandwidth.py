"""Estimates whether the webcams of a USB bus fit on it, and which lower mode would fit.

A camera reserves bandwidth when it begins to stream; the last one may get none. The kernel does not report the
reservations, so they are estimated from the requested modes.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mocapd.capture.webcam.v4l2_ioctl import PixelFormat
from mocapd.capture.webcam.webcams import SYSFS

_JPEG_SHARE = 0.2  # of the bytes of YUYV: webcams reserve for their worst picture
# What webcams can reserve together [bytes/s]. High speed: 80 % of 60 MB/s may be periodic (USB 2.0
# specification, §5.6.4), of which packet overhead and coarse alternate settings take a quarter.
_USABLE: Mapping[int, float] = {12: 0.9e6, 480: 36e6, 5000: 320e6}


@dataclass(frozen=True, slots=True)
class Mode:
    """A requested mode of a webcam."""

    fourcc: str
    size_px: tuple[int, int]  # width, height
    fps_hz: float

    @property
    def bytes_per_s(self) -> float:
        """Bandwidth on the bus: YUYV has two bytes a pixel, MJPG about a fifth of that."""
        share = _JPEG_SHARE if self.fourcc == "MJPG" else 1.0
        return 2.0 * share * self.size_px[0] * self.size_px[1] * self.fps_hz


@dataclass(frozen=True, slots=True)
class CrowdedBus:
    """An overloaded bus. `cameras`: names, in the order given."""

    bus: str
    cameras: tuple[str, ...]
    asked_bytes_per_s: float
    usable_bytes_per_s: float


def usable_bytes_per_s(port_path: str, sysfs: Path = SYSFS) -> float:
    """The bandwidth for all webcams of this port's bus; that of USB 2 when unknown."""
    try:
        text = (sysfs / "bus/usb/devices" / port_path / "speed").read_text(encoding="ascii")
        speed = float(text)
    except (OSError, ValueError):
        speed = 480.0
    return max(
        (usable for mbit, usable in _USABLE.items() if mbit <= speed), default=min(_USABLE.values())
    )


def crowded_buses(
    cameras: Mapping[str, tuple[str, Mode]], sysfs: Path = SYSFS
) -> tuple[CrowdedBus, ...]:
    """The overloaded buses. cameras: port path and mode by camera name."""
    by_bus: dict[str, list[str]] = {}
    for name, (port_path, _mode) in cameras.items():
        by_bus.setdefault(port_path.partition("-")[0], []).append(name)
    crowded = []
    for bus, names in by_bus.items():
        asked = sum(cameras[name][1].bytes_per_s for name in names)
        usable = min(usable_bytes_per_s(cameras[name][0], sysfs) for name in names)
        if asked > usable:
            crowded.append(CrowdedBus(bus, tuple(names), asked, usable))
    return tuple(crowded)


def lower_mode(
    formats: Sequence[PixelFormat], asked: Mode, budget_bytes_per_s: float
) -> Mode | None:
    """The best mode within a budget, not above `asked` in size or rate; None when there is none.

    MJPG where there is any, as the camera will be opened with it. The best has the most of
    sqrt(pixels) times rate; of equals, the faster. Under 320x240 or 10 Hz nothing is tracked.
    """
    fourcc = "MJPG" if any(format_.fourcc == "MJPG" for format_ in formats) else "YUYV"
    fitting = [
        mode
        for format_ in formats
        if format_.fourcc == fourcc and format_.size_px[0] >= 320 and format_.size_px[1] >= 240
        for mode in (Mode(fourcc, format_.size_px, rate_hz) for rate_hz in format_.rates_hz)
        if mode.bytes_per_s <= budget_bytes_per_s
        and 10.0 <= mode.fps_hz <= asked.fps_hz + 0.5
        and mode.size_px[0] <= asked.size_px[0]
        and mode.size_px[1] <= asked.size_px[1]
        and (mode.size_px, mode.fps_hz) != (asked.size_px, asked.fps_hz)
    ]
    return max(
        fitting,
        key=lambda mode: (math.sqrt(math.prod(mode.size_px)) * mode.fps_hz, mode.fps_hz),
        default=None,
    )
