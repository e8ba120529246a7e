"""Exposure, gain, white balance and focus of a webcam: set in the order that works, read back.

A driver's answer to `set` is meaningless (gain 999 is accepted and becomes 255), so the result
holds the values read back. Values survive reopening but not a replug: apply them at each
opening.
"""

from dataclasses import dataclass

from mocapd.capture.webcam.camera_controls import Control, ControlDevice, power_line_code
from mocapd.errors import ConfigError

# the field of each automatic, its codes for off and on, and the field of its value
_AUTOMATICS = (
    ("auto_exposure", (1, 3), "exposure"),
    ("auto_wb", (0, 1), "wb_temperature"),
    ("autofocus", (0, 1), "focus"),
)
_CONTROLS = {
    "auto_exposure": Control.AUTO_EXPOSURE,
    "exposure": Control.EXPOSURE,
    "gain": Control.GAIN,
    "auto_wb": Control.AUTO_WB,
    "wb_temperature": Control.WB_TEMPERATURE,
    "autofocus": Control.AUTOFOCUS,
    "focus": Control.FOCUS,
    "dynamic_framerate": Control.DYNAMIC_FRAMERATE,
    "power_line_hz": Control.POWER_LINE,
}


@dataclass(frozen=True, slots=True)
class Controls:
    """Control values; None leaves the camera's own value.

    `exposure` in the camera's unit (UVC: 100 us), `wb_temperature` [K], `gain` and `focus` without
    a unit. A value turns its automatic off, unless the automatic is asked for explicitly.
    `dynamic_framerate`: whether the camera may lower its rate in dim light; `power_line_hz`: the mains
    frequency of the flicker filter, 50 or 60, 0 for none.
    """

    auto_exposure: bool | None = None
    exposure: int | None = None
    gain: int | None = None
    auto_wb: bool | None = None
    wb_temperature: int | None = None
    autofocus: bool | None = None
    focus: int | None = None
    dynamic_framerate: bool | None = None
    power_line_hz: int | None = None

    def __post_init__(self) -> None:
        if self.power_line_hz not in (None, 0, 50, 60):
            raise ConfigError(
                f"no mains of {self.power_line_hz} Hz",
                "power_line_hz",
                "give 50, 60, or 0 for none",
            )


@dataclass(frozen=True, slots=True)
class ControlResult:
    """The requested and the actual value, as V4L2 counts; `got` is None when the camera lacks the control."""

    control: Control
    asked: int
    got: int | None

    @property
    def is_applied(self) -> bool:
        return self.asked == self.got


def control_steps(controls: Controls) -> dict[str, int]:
    """The values by name, in the order to set them: each automatic before its value."""
    steps: dict[str, int] = {}
    for switch, codes, name in _AUTOMATICS:
        automatic, value = getattr(controls, switch), getattr(controls, name)
        if automatic is None and value is not None:
            automatic = False
        if automatic is not None:
            steps[switch] = codes[automatic]
        if value is not None and not automatic:
            steps[name] = value
    if controls.gain is not None:
        steps["gain"] = controls.gain
    if controls.dynamic_framerate is not None:
        steps["dynamic_framerate"] = int(controls.dynamic_framerate)
    if controls.power_line_hz is not None:
        steps["power_line_hz"] = power_line_code(controls.power_line_hz)
    return steps


def apply_controls(device: ControlDevice, controls: Controls) -> tuple[ControlResult, ...]:
    """Sets all given controls, and reads them back. Raises UnavailableError."""
    return tuple(
        ControlResult(_CONTROLS[name], value, device.write(_CONTROLS[name], value))
        for name, value in control_steps(controls).items()
    )
