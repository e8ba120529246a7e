"""Locks a camera's automatics: enable them to settle, lock their values, restore the earlier state.

All functions use a `ControlDevice`, so they work while another thread streams. UVC cameras set a value only
while its automatic is off, so an automatic goes before its value, each way.
"""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from mocapd.capture.webcam.camera_controls import (
    AUTOMATICS,
    SWITCHES,
    Control,
    ControlDevice,
    power_line_code,
)
from mocapd.capture.webcam.controls import Controls, given_values
from mocapd.capture.webcam.v4l2 import WebcamSettings

_AUTO_EVERYTHING = 0  # of AUTO_EXPOSURE
UNITS_PER_S = 10_000
"""Units of the control EXPOSURE, 100 us each."""


@runtime_checkable
class Lockable(Protocol):
    """A source whose controls can be set while its thread reads."""

    @property
    def settings(self) -> WebcamSettings:
        """The settings of each opening."""
        ...

    def device(self) -> ControlDevice | None:
        """Its controls; None while it is not open."""
        ...

    def change(self, settings: WebcamSettings) -> None:
        """Sets the settings of the next opening; another size or rate reopens the camera at once."""
        ...


Held = Mapping[Control, int]
"""The controls that a camera has, and their values."""


def read_held(device: ControlDevice) -> Held:
    """Reads all controls that a lock may change. Raises UnavailableError."""
    values = {}
    for control in Control:
        value = device.read(control) if device.range(control) is not None else None
        if value is not None:
            values[control] = value
    return values


def set_free(device: ControlDevice, held: Held) -> None:
    """Switch the automatics on, but for the one that would lower the rate. Raises UnavailableError."""
    if Control.DYNAMIC_FRAMERATE in held:
        device.write(Control.DYNAMIC_FRAMERATE, 0)
    for automatic in AUTOMATICS:
        # without both controls the automatic's value could not be restored
        if automatic.switch not in held or automatic.value not in held:
            continue
        now = device.write(automatic.switch, automatic.on)
        if now == automatic.off and automatic.switch is Control.AUTO_EXPOSURE:
            device.write(automatic.switch, _AUTO_EVERYTHING)  # the few that steer an iris too


def lock(device: ControlDevice, held: Held, fps_hz: float, mains_hz: int | None = None) -> Controls:
    """Switch the automatics off and keep the values they have found.

    held: what the camera has; fps_hz: its rate, which no exposure may lower; mains_hz: 50 or 60 when
    lamps flicker: the exposure becomes a multiple of their period, 1/100 or 1/120 s.
    Returns what the camera holds now, as it is asked for at each opening. Raises UnavailableError.
    """
    settled = {a.value: device.read(a.value) for a in AUTOMATICS if a.value in held}
    gain = device.read(Control.GAIN) if Control.GAIN in held else None
    for automatic in AUTOMATICS:
        if automatic.switch in held:
            device.write(automatic.switch, automatic.off)
        value = settled.get(automatic.value)
        if value is not None:
            if automatic.value is Control.EXPOSURE:
                value = exposure_units(value, fps_hz, mains_hz)
            device.write(automatic.value, value)
    if gain is not None:
        device.write(Control.GAIN, gain)
    if mains_hz is not None and Control.POWER_LINE in held:
        device.write(Control.POWER_LINE, power_line_code(mains_hz))
    return as_controls(device, held, mains_hz)


def exposure_units(wanted: int, fps_hz: float, mains_hz: int | None) -> int:
    """An exposure [100 us] that fits in a frame at `fps_hz` and, with `mains_hz`, does not flicker.

    Light from the mains pulses at twice their frequency; whole pulses always add up to the same. An
    exposure under half a pulse stays as it is: a whole one would be white.
    """
    longest = int(UNITS_PER_S / fps_hz)
    if mains_hz is None:
        return max(1, min(wanted, longest))
    pulse = UNITS_PER_S / (2 * mains_hz)
    if wanted < pulse / 2:
        return max(1, wanted)
    pulses = max(1, min(round(wanted / pulse), int(longest / pulse + 1e-9)))
    return round(pulses * pulse)


def as_controls(device: ControlDevice, held: Held, mains_hz: int | None = None) -> Controls:
    """The current values of the camera's controls, for its next opening."""

    def value(control: Control) -> int | None:
        return device.read(control) if control in held else None

    def off(control: Control) -> bool | None:
        return False if control in held else None

    return Controls(
        auto_exposure=off(Control.AUTO_EXPOSURE),
        exposure=value(Control.EXPOSURE),
        gain=value(Control.GAIN),
        auto_wb=off(Control.AUTO_WB),
        wb_temperature=value(Control.WB_TEMPERATURE),
        autofocus=off(Control.AUTOFOCUS),
        focus=value(Control.FOCUS),
        dynamic_framerate=off(Control.DYNAMIC_FRAMERATE),
        power_line_hz=mains_hz if Control.POWER_LINE in held else None,
    )


def as_held(controls: Controls) -> Held:
    """The values of a lock, for `restore`, which switches their automatics off."""
    given = given_values(controls)
    return {control: value for control, value in given.items() if control not in SWITCHES}


def restore(device: ControlDevice, before: Held) -> None:
    """Restores earlier values. Raises UnavailableError."""
    for automatic in AUTOMATICS:
        was = before.get(automatic.switch)
        if was in (None, automatic.off) and automatic.value in before:
            device.write(automatic.switch, automatic.off)
            device.write(automatic.value, before[automatic.value])
        if was is not None:
            device.write(automatic.switch, was)
    for control in (Control.GAIN, Control.DYNAMIC_FRAMERATE, Control.POWER_LINE):
        if control in before:
            device.write(control, before[control])
