"""Exposure, gain, white balance and focus of a webcam: set in the order that works, read back.

A driver's answer to `set` is meaningless (gain 999 is accepted and becomes 255), so the result
holds the values read back. Values survive reopening but not a replug: apply them at each
opening.
"""

from dataclasses import dataclass
from typing import Protocol

from mocapd.capture.webcam.camera_controls import Control, ControlDevice, power_line_code
from mocapd.errors import ConfigError

_EXPOSURE_MANUAL = 1.0
_EXPOSURE_AUTO = 3.0


class HasProperties(Protocol):
    """The required part of cv2.VideoCapture."""

    def set(self, property_id: int, value: float) -> bool: ...
    def get(self, property_id: int) -> float: ...


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
    """A control's requested and actual value; `got` is -1 when the camera lacks the control."""

    name: str
    asked: float
    got: float

    @property
    def is_applied(self) -> bool:
        return self.asked == self.got


def control_steps(controls: Controls) -> tuple[tuple[str, int, float], ...]:
    """(name, cv2 property, value) in the order to set them: each automatic before its value."""
    # imported here: the configuration uses Controls and must load without OpenCV
    import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

    import cv2

    groups = (
        (
            ("auto_exposure", cv2.CAP_PROP_AUTO_EXPOSURE, controls.auto_exposure),
            (_EXPOSURE_MANUAL, _EXPOSURE_AUTO),
            ("exposure", cv2.CAP_PROP_EXPOSURE, controls.exposure),
        ),
        (
            ("auto_wb", cv2.CAP_PROP_AUTO_WB, controls.auto_wb),
            (0.0, 1.0),
            ("wb_temperature", cv2.CAP_PROP_WB_TEMPERATURE, controls.wb_temperature),
        ),
        (
            ("autofocus", cv2.CAP_PROP_AUTOFOCUS, controls.autofocus),
            (0.0, 1.0),
            ("focus", cv2.CAP_PROP_FOCUS, controls.focus),
        ),
    )
    steps: list[tuple[str, int, float]] = []
    for (auto_name, auto_property, automatic), codes, (name, number, value) in groups:
        if automatic is None and value is not None:
            automatic = False
        if automatic is not None:
            steps.append((auto_name, auto_property, codes[automatic]))
        if value is not None and not automatic:
            steps.append((name, number, float(value)))
    if controls.gain is not None:
        steps.append(("gain", cv2.CAP_PROP_GAIN, float(controls.gain)))
    return tuple(steps)


def apply_controls(capture: HasProperties, controls: Controls) -> tuple[ControlResult, ...]:
    """Sets all given controls, then reads them back."""
    steps = control_steps(controls)
    for _, number, value in steps:
        capture.set(number, value)
    return tuple(ControlResult(name, value, capture.get(number)) for name, number, value in steps)


def apply_unknown_to_opencv(device: ControlDevice, controls: Controls) -> tuple[ControlResult, ...]:
    """Set what OpenCV has no property for, and read it back. Raises UnavailableError."""
    asked: list[tuple[str, Control, int]] = []
    if controls.dynamic_framerate is not None:
        value = int(controls.dynamic_framerate)
        asked.append(("dynamic_framerate", Control.DYNAMIC_FRAMERATE, value))
    if controls.power_line_hz is not None:
        value = power_line_code(controls.power_line_hz)
        asked.append(("power_line_hz", Control.POWER_LINE, value))
    results = []
    for name, control, value in asked:
        got = device.write(control, value)
        results.append(ControlResult(name, value, -1.0 if got is None else got))
    return tuple(results)
