"""V4L2 queries that OpenCV lacks: capabilities, formats, rates, use by other programs, ranges of controls.

Layouts are those of <linux/videodev2.h>, the same on all 64-bit Linux machines.
"""

import errno
import fcntl
import struct
from collections.abc import Iterator
from dataclasses import dataclass

_CAP_VIDEO_CAPTURE = 0x00000001
_CAP_DEVICE_CAPS = 0x80000000
_BUF_TYPE_VIDEO_CAPTURE = 1
_MEMORY_MMAP = 1
_DISCRETE = 1

_CAPABILITY = struct.Struct("16s32s32s6I")
_FMTDESC = struct.Struct("3I32s5I")
_FRMSIZE = struct.Struct("11I")
_FRMIVAL = struct.Struct("13I")
_REQBUFS = struct.Struct("5I")
_CONTROL = struct.Struct("Ii")
_QUERYCTRL = struct.Struct("2I32s4i3I")
_FLAG_DISABLED = 0x0001
_FLAG_READ_ONLY = 0x0004


def _iowr(number: int, size: int, read_only: bool = False) -> int:
    """_IOWR('V', number, size), or _IOR."""
    return ((2 if read_only else 3) << 30) | (size << 16) | (ord("V") << 8) | number


_QUERYCAP = _iowr(0, _CAPABILITY.size, read_only=True)
_ENUM_FMT = _iowr(2, _FMTDESC.size)
_REQUEST_BUFFERS = _iowr(8, _REQBUFS.size)
_GET_CONTROL = _iowr(27, _CONTROL.size)
_SET_CONTROL = _iowr(28, _CONTROL.size)
_QUERY_CONTROL = _iowr(36, _QUERYCTRL.size)
_ENUM_FRAMESIZES = _iowr(74, _FRMSIZE.size)
_ENUM_FRAMEINTERVALS = _iowr(75, _FRMIVAL.size)


@dataclass(frozen=True, slots=True)
class PixelFormat:
    """One format at one size. `rates_hz` is empty where the driver reports only a range."""

    fourcc: str
    size_px: tuple[int, int]  # width, height
    rates_hz: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ControlRange:
    """Permitted values of a control: `low` to `high` in steps."""

    low: int
    high: int
    step: int


def captures_video(fd: int) -> bool:
    """VIDIOC_QUERYCAP, of this node, not of the whole device. Raises OSError (ENOTTY: not a V4L2 node)."""
    raw = fcntl.ioctl(fd, _QUERYCAP, bytes(_CAPABILITY.size))
    *_, caps, device_caps = _CAPABILITY.unpack(raw)[:6]
    return bool((device_caps if caps & _CAP_DEVICE_CAPS else caps) & _CAP_VIDEO_CAPTURE)


def enumerate_formats(fd: int) -> tuple[PixelFormat, ...]:
    """VIDIOC_ENUM_FMT with the discrete sizes of each format and the rates of each size."""
    return tuple(
        PixelFormat(_fourcc(code), size, tuple(_rates_hz(fd, code, size)))
        for code in _format_codes(fd)
        for size in _sizes_px(fd, code)
    )


def is_streaming_elsewhere(fd: int) -> bool:
    """True if another process streams from this node.

    Asks for zero buffers, which changes nothing and is refused (EBUSY) during streaming.
    """
    nothing = _REQBUFS.pack(0, _BUF_TYPE_VIDEO_CAPTURE, _MEMORY_MMAP, 0, 0)
    try:
        fcntl.ioctl(fd, _REQUEST_BUFFERS, nothing)
    except OSError as error:
        return error.errno == errno.EBUSY
    return False


def query_control(fd: int, control_id: int) -> ControlRange | None:
    """VIDIOC_QUERYCTRL: None for a control that cannot be set, also as its range is one value or ends before it begins.
    Raises OSError (EINVAL: the camera lacks it)."""
    raw = fcntl.ioctl(
        fd, _QUERY_CONTROL, struct.pack("I", control_id).ljust(_QUERYCTRL.size, b"\0")
    )
    _id, _kind, _name, low, high, step, _default, flags, *_ = _QUERYCTRL.unpack(raw)
    if flags & (_FLAG_DISABLED | _FLAG_READ_ONLY) or low >= high:
        return None
    return ControlRange(low, high, max(step, 1))


def get_control(fd: int, control_id: int) -> int:
    """VIDIOC_G_CTRL, also while another descriptor streams. Raises OSError."""
    value: int = _CONTROL.unpack(fcntl.ioctl(fd, _GET_CONTROL, _CONTROL.pack(control_id, 0)))[1]
    return value


def set_control(fd: int, control_id: int, value: int) -> None:
    """VIDIOC_S_CTRL. Raises OSError (EACCES: its automatic is on; ERANGE; EIO: the camera refuses)."""
    fcntl.ioctl(fd, _SET_CONTROL, _CONTROL.pack(control_id, value))


def _fourcc(code: int) -> str:
    return code.to_bytes(4, "little").decode("ascii", "replace").rstrip()


def _enumerate(
    fd: int, request: int, layout: struct.Struct, *head: int
) -> Iterator[tuple[int, ...]]:
    """Ask with index 0, 1, ... in the place of `head`'s -1 until the driver says EINVAL.

    An unplugged device ends the list too; the next question says what happened.
    """
    index = 0
    while True:
        fields = [index if value == -1 else value for value in head]
        try:
            raw = fcntl.ioctl(
                fd, request, struct.pack(f"{len(fields)}I", *fields).ljust(layout.size, b"\0")
            )
        except OSError as error:
            if error.errno in (errno.EINVAL, errno.ENOTTY, errno.ENODEV):
                return
            raise
        yield layout.unpack(raw)
        index += 1


def _format_codes(fd: int) -> list[int]:
    answers = _enumerate(fd, _ENUM_FMT, _FMTDESC, -1, _BUF_TYPE_VIDEO_CAPTURE)
    return [answer[4] for answer in answers]  # index, type, flags, description, pixelformat


def _sizes_px(fd: int, code: int) -> list[tuple[int, int]]:
    answers = _enumerate(fd, _ENUM_FRAMESIZES, _FRMSIZE, -1, code)
    sizes: list[tuple[int, int]] = []
    for _index, _code, kind, *numbers in answers:
        if kind != _DISCRETE:  # a range: min, max, step of width, then of height
            sizes.append((numbers[1], numbers[4]))
            break
        sizes.append((numbers[0], numbers[1]))
    return sizes


def _rates_hz(fd: int, code: int, size_px: tuple[int, int]) -> Iterator[float]:
    answers = _enumerate(fd, _ENUM_FRAMEINTERVALS, _FRMIVAL, -1, code, *size_px)
    for *_, kind, numerator, denominator, _a, _b, _c, _d, _e, _f in answers:
        if kind != _DISCRETE:
            return
        if numerator:
            yield denominator / numerator
