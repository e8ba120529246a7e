"""Reads and sets the controls of a webcam by name, also while another thread or program streams from it.

V4L2 answers control questions on a second descriptor of a node that streams (V4L2 API, "Opening and
Closing Devices"). The descriptor lives for one question only: held over an unplugging it would keep
the node's number taken, and the camera would come back under another.
"""

import errno
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

from mocapd.capture.webcam.device_access import opened_node
from mocapd.capture.webcam.v4l2_ioctl import ControlRange, get_control, query_control, set_control
from mocapd.errors import UnavailableError


class Control(StrEnum):
    """The controls that decide whether two pictures of one scene are alike."""

    AUTO_EXPOSURE = "auto_exposure"  # 1 manual, 3 the camera's own (0 and 2 are rare)
    EXPOSURE = "exposure_time_absolute"  # [100 us]
    DYNAMIC_FRAMERATE = "exposure_dynamic_framerate"  # 1: longer exposures at a lower rate
    GAIN = "gain"
    AUTO_WB = "white_balance_automatic"
    WB_TEMPERATURE = "white_balance_temperature"  # [K]
    AUTOFOCUS = "focus_automatic_continuous"
    FOCUS = "focus_absolute"
    POWER_LINE = "power_line_frequency"  # 0 off, 1 50 Hz, 2 60 Hz, 3 automatic


@dataclass(frozen=True, slots=True)
class Automatic:
    """A switch, its codes for off and on, and the value that it drives."""

    switch: Control
    off: int
    on: int
    value: Control


AUTOMATICS = (
    Automatic(Control.AUTO_EXPOSURE, 1, 3, Control.EXPOSURE),
    Automatic(Control.AUTO_WB, 0, 1, Control.WB_TEMPERATURE),
    Automatic(Control.AUTOFOCUS, 0, 1, Control.FOCUS),
)
SWITCHES = frozenset(automatic.switch for automatic in AUTOMATICS)

_IDS: Mapping[Control, int] = MappingProxyType(
    {  # <linux/v4l2-controls.h>
        Control.AUTO_EXPOSURE: 0x009A0901,
        Control.EXPOSURE: 0x009A0902,
        Control.DYNAMIC_FRAMERATE: 0x009A0903,
        Control.GAIN: 0x00980913,
        Control.AUTO_WB: 0x0098090C,
        Control.WB_TEMPERATURE: 0x0098091A,
        Control.AUTOFOCUS: 0x009A090C,
        Control.FOCUS: 0x009A090A,
        Control.POWER_LINE: 0x00980918,
    }
)
_POWER_LINE_CODES: Mapping[int, int] = MappingProxyType({0: 0, 50: 1, 60: 2})


def power_line_code(mains_hz: int) -> int:
    """The value of POWER_LINE for 0 (no filter), 50 or 60 Hz."""
    return _POWER_LINE_CODES[mains_hz]


class ControlDevice(Protocol):
    """Access to a camera's controls. Every method raises UnavailableError when the camera is absent."""

    def range(self, control: Control) -> ControlRange | None:
        """The control's range; None when the camera lacks it."""
        ...

    def read(self, control: Control) -> int | None:
        """The control's value; None when the camera lacks it or refuses to answer."""
        ...

    def write(self, control: Control, value: int) -> int | None:
        """Sets a value; returns the value read back, as drivers clip or refuse."""
        ...


class NodeControls:
    """The controls of a /dev/video node."""

    def __init__(self, node: Path) -> None:
        self._node = node

    def range(self, control: Control) -> ControlRange | None:
        """See ControlDevice."""
        with opened_node(self._node) as fd:
            try:
                return query_control(fd, _IDS[control])
            except OSError as error:
                self._check_present(error)
                return None

    def read(self, control: Control) -> int | None:
        """See ControlDevice."""
        with opened_node(self._node) as fd:
            return self._read(fd, control)

    def write(self, control: Control, value: int) -> int | None:
        """See ControlDevice."""
        with opened_node(self._node) as fd:
            try:
                set_control(fd, _IDS[control], value)
            except OSError as error:
                self._check_present(error)
            return self._read(fd, control)

    def _read(self, fd: int, control: Control) -> int | None:
        try:
            return get_control(fd, _IDS[control])
        except OSError as error:
            self._check_present(error)
            return None

    def _check_present(self, error: OSError) -> None:
        """Raises UnavailableError when the camera is absent. Any other error is one control's: cameras answer some
        with "not ready", or not at all, and deliver pictures."""
        if error.errno == errno.ENODEV:
            raise UnavailableError("was unplugged", str(self._node), "plug it in again") from None
