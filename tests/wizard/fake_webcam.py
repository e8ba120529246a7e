"""A webcam's controls and its picture, as far as the lock of controls needs them. Not a driver: it
behaves as UVC cameras were seen to (values refused under their automatic, gains clipped)."""

import numpy as np

from mocapd.capture.webcam.camera_controls import Control
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.capture.webcam.v4l2_ioctl import ControlRange
from mocapd.errors import CameraLost, UnavailableError
from mocapd.types import Bytes, Frame

RANGES = {
    Control.AUTO_EXPOSURE: ControlRange(0, 3, 1),
    Control.EXPOSURE: ControlRange(3, 2047, 1),
    Control.DYNAMIC_FRAMERATE: ControlRange(0, 1, 1),
    Control.GAIN: ControlRange(0, 255, 1),
    Control.AUTO_WB: ControlRange(0, 1, 1),
    Control.WB_TEMPERATURE: ControlRange(2800, 6500, 1),
    Control.AUTOFOCUS: ControlRange(0, 1, 1),
    Control.FOCUS: ControlRange(0, 250, 5),
    Control.POWER_LINE: ControlRange(0, 2, 1),
}
FACTORY = {
    Control.AUTO_EXPOSURE: 3,
    Control.EXPOSURE: 250,
    Control.DYNAMIC_FRAMERATE: 1,
    Control.GAIN: 64,
    Control.AUTO_WB: 1,
    Control.WB_TEMPERATURE: 4000,
    Control.AUTOFOCUS: 1,
    Control.FOCUS: 30,
    Control.POWER_LINE: 1,
}
UNDER = {
    Control.EXPOSURE: (Control.AUTO_EXPOSURE, 1),
    Control.WB_TEMPERATURE: (Control.AUTO_WB, 0),
    Control.FOCUS: (Control.AUTOFOCUS, 0),
}


class FakeDevice:
    """The ControlDevice of a FakeWebcam."""

    def __init__(self, webcam: "FakeWebcam") -> None:
        self._webcam = webcam

    def range(self, control: Control) -> ControlRange | None:
        return RANGES[control] if control in self._values else None

    def read(self, control: Control) -> int | None:
        self._webcam.tell(control)
        return self._values.get(control)

    def write(self, control: Control, value: int) -> int | None:
        if control not in self._values:
            return None
        switch, manual = UNDER.get(control, (None, 0))
        if switch is None or self._values[switch] == manual:
            low, high = RANGES[control].low, RANGES[control].high
            self._values[control] = min(max(value, low), high)
        return self._values[control]

    @property
    def _values(self) -> dict[Control, int]:
        if not self._webcam.plugged:
            raise UnavailableError("unplugged", self._webcam.name, "plug it in again")
        return self._webcam.values


class FakeWebcam:
    """A Source that is Lockable. `tells`: whether its automatics tell the values they have found;
    light: brightness of the scene per 100 us; pulses_hz: of lamps that flicker; opened: how often it was
    opened anew in another mode."""

    recorded = False

    def __init__(
        self, name: str, light: float = 0.6, tells: bool = True, pulses_hz: float = 0.0
    ) -> None:
        self.name = name
        self.values = dict(FACTORY)
        self.plugged = True
        self.light, self.pulses_hz = light, pulses_hz
        self._tells = tells
        self._settings = WebcamSettings()
        self.opened = 0

    # -- Source, Lockable ------------------------------------------------------------------------

    def open(self) -> None: ...

    def read(self) -> Frame:
        raise CameraLost("pictures come from `picture`", self.name)

    def close(self) -> None: ...

    @property
    def settings(self) -> WebcamSettings:
        return self._settings

    def device(self) -> FakeDevice | None:
        return FakeDevice(self) if self.plugged else None

    def change(self, settings: WebcamSettings) -> None:
        if settings.size_px != self._settings.size_px:
            self.opened += 1
        self._settings = settings

    def tell(self, control: Control) -> None:
        """What the automatic has found becomes the control's value, in cameras that tell."""
        if self._tells and control is Control.EXPOSURE:
            self.values[control] = self._exposure()

    # -- the picture -----------------------------------------------------------------------------

    def _exposure(self) -> int:
        if self.values[Control.AUTO_EXPOSURE] != 3:
            return self.values[Control.EXPOSURE]
        longest = 333 if not self.values[Control.DYNAMIC_FRAMERATE] else 1000
        return int(np.clip(110 / (self.light * self._gain()), 3, longest))

    def _gain(self) -> float:
        return 1.0 + self.values[Control.GAIN] / 64

    def picture(self, t_ns: int) -> Bytes:
        """(48,64,3) at this instant: the brightness of each row, and warmer with the temperature."""
        exposure_s = self._exposure() / 1e4
        rows_s = t_ns / 1e9 + 0.025 * np.arange(48) / 48
        pulse = np.ones(48)
        if self.pulses_hz:
            reduced = np.sinc(self.pulses_hz * exposure_s)
            pulse += 0.4 * reduced * np.cos(2 * np.pi * self.pulses_hz * (rows_s + exposure_s / 2))
        level = self.light * self._gain() * self._exposure() * pulse
        warm = 1.0
        if not self.values[Control.AUTO_WB]:
            warm = self.values[Control.WB_TEMPERATURE] / 4000
        colour = np.array([1.0, 1.0, warm])
        picture = np.ones((48, 64, 1)) * level[:, None, None] * colour
        texture = 0.6 + 0.8 * (np.arange(64) % 8 > 3)[None, :, None]
        pixels: Bytes = np.clip(picture * texture, 0, 255).astype(np.uint8)
        return pixels
