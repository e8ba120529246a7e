"""Exposure, gain, white balance and focus of a webcam: set in the order that works, read back.

A driver's answer to `set` is meaningless (gain 999 is accepted and becomes 255), so the result
holds the values read back. Values survive reopening but not a replug: apply them at each
opening.
"""

from dataclasses import dataclass

from mocapd.capture.webcam.camera_controls import (
    AUTOMATICS,
    Control,
    ControlDevice,
    power_line_code,
)
from mocapd.errors import ConfigError

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


def given_values(controls: Controls) -> dict[Control, int]:
    """The values that are given, as V4L2 counts them; of an automatic 0 or 1."""
    given = {control: getattr(controls, name) for name, control in _CONTROLS.items()}
    if controls.power_line_hz is not None:
        given[Control.POWER_LINE] = power_line_code(controls.power_line_hz)
    return {control: int(value) for control, value in given.items() if value is not None}


def control_steps(controls: Controls) -> dict[Control, int]:
    """The values in the order to set them: each automatic before its value."""
    steps: dict[Control, int] = {}
    given = given_values(controls)
    for automatic in AUTOMATICS:
        is_on = given.pop(automatic.switch, 0 if automatic.value in given else None)
        value = given.pop(automatic.value, None)
        if is_on is not None:
            steps[automatic.switch] = automatic.on if is_on else automatic.off
        if value is not None and not is_on:
            steps[automatic.value] = value
    return steps | given


def apply_controls(device: ControlDevice, controls: Controls) -> tuple[ControlResult, ...]:
    """Sets all given controls, and reads them back. Raises UnavailableError."""
    return tuple(
        ControlResult(control, value, device.write(control, value))
        for control, value in control_steps(controls).items()
    )
