"""Locking and giving back controls, exposures that do not flicker, and what fits on a USB bus."""

import errno
import fcntl
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.capture.webcam import v4l2_ioctl
from mocapd.capture.webcam.camera_controls import Control, NodeControls
from mocapd.capture.webcam.control_lock import exposure_units, lock, read_held, restore, set_free
from mocapd.capture.webcam.controls import Controls, apply_controls, control_steps
from mocapd.capture.webcam.usb_bandwidth import Mode, crowded_buses, lower_mode, usable_bytes_per_s
from mocapd.capture.webcam.v4l2_ioctl import ControlRange, PixelFormat
from mocapd.errors import ConfigError, UnavailableError

HELD = {
    Control.AUTO_EXPOSURE: 3,
    Control.EXPOSURE: 250,
    Control.DYNAMIC_FRAMERATE: 1,
    Control.GAIN: 10,
    Control.AUTO_WB: 1,
    Control.WB_TEMPERATURE: 4600,
    Control.POWER_LINE: 2,
}
UNDER = {Control.EXPOSURE: (Control.AUTO_EXPOSURE, 1), Control.WB_TEMPERATURE: (Control.AUTO_WB, 0)}
LIMITS = {Control.GAIN: 255}


class StrictDevice:
    """Without focus; clips, refuses values under their automatic, and notes each write."""

    def __init__(self, **changed: int) -> None:
        self.held = {**HELD, **{Control[name]: value for name, value in changed.items()}}
        self.refused: list[Control] = []

    def range(self, control: Control) -> ControlRange | None:
        return ControlRange(0, 10_000, 1) if control in self.held else None

    def read(self, control: Control) -> int | None:
        return self.held.get(control)

    def write(self, control: Control, value: int) -> int | None:
        switch, manual = UNDER.get(control, (None, 0))
        if control not in self.held or (switch is not None and self.held[switch] != manual):
            self.refused.append(control)
        else:
            self.held[control] = min(value, LIMITS.get(control, value))
        return self.held.get(control)


def test_a_lock_holds_what_was_found_and_touches_only_what_there_is() -> None:
    device = StrictDevice()
    controls = lock(device, read_held(device), 30.0)
    assert controls == Controls(
        auto_exposure=False, exposure=250, gain=10, auto_wb=False, wb_temperature=4600,
        dynamic_framerate=False,
    )  # fmt: skip
    assert device.held[Control.AUTO_EXPOSURE] == 1
    assert device.refused == []


def test_a_lock_shortens_exposures_that_would_lower_the_rate() -> None:
    device = StrictDevice(EXPOSURE=800)
    assert lock(device, read_held(device), 30.0).exposure == 333


@pytest.mark.parametrize(
    "before",
    [{}, {"AUTO_EXPOSURE": 1, "EXPOSURE": 77}, {"AUTO_WB": 0, "WB_TEMPERATURE": 3000}],
)
def test_what_was_is_given_back(before: dict[str, int]) -> None:
    device = StrictDevice(**before)
    held = read_held(device)
    set_free(device, held)
    device.held |= {Control.GAIN: 99}
    if device.held[Control.AUTO_EXPOSURE] == 3:
        device.held[Control.EXPOSURE] = 180
    lock(device, held, 30.0, mains_hz=50)
    restore(device, held)
    ignored = [value for value, (switch, manual) in UNDER.items() if held[switch] != manual]
    assert {k: v for k, v in device.held.items() if k not in ignored} == {
        k: v for k, v in held.items() if k not in ignored
    }
    assert device.refused == []


@given(
    wanted=st.integers(1, 5000), fps_hz=st.floats(5, 60), mains_hz=st.sampled_from([None, 50, 60])
)
def test_exposures_fit_in_a_frame_and_in_the_pulses_of_the_mains(
    wanted: int, fps_hz: float, mains_hz: int | None
) -> None:
    units = exposure_units(wanted, fps_hz, mains_hz)
    pulse = 10_000 / (2 * mains_hz) if mains_hz else 0.0
    assert units <= max(1, 10_000 / fps_hz, pulse) + 0.5
    if mains_hz is not None and wanted >= pulse / 2:
        assert abs(units / pulse - round(units / pulse)) < 0.01
    elif mains_hz is None and wanted <= int(10_000 / fps_hz):
        assert units == wanted


def test_values_take_effect_because_the_automatic_goes_off_first() -> None:
    device = StrictDevice()
    results = apply_controls(device, Controls(exposure=100, wb_temperature=5000))
    assert all(one.is_applied for one in results)
    assert device.held[Control.EXPOSURE] == 100
    assert device.held[Control.WB_TEMPERATURE] == 5000
    assert device.refused == []


def test_what_was_not_applied_shows() -> None:
    device = StrictDevice()
    del device.held[Control.POWER_LINE]
    wanted = Controls(gain=999, focus=30, dynamic_framerate=False, power_line_hz=50)
    results = apply_controls(device, wanted)
    assert {one.control: (one.asked, one.got) for one in results if not one.is_applied} == {
        Control.GAIN: (999, 255),
        Control.AUTOFOCUS: (0, None),
        Control.FOCUS: (30, None),
        Control.POWER_LINE: (1, None),
    }
    assert device.held[Control.DYNAMIC_FRAMERATE] == 0


def test_nothing_is_touched_without_being_asked_for() -> None:
    assert control_steps(Controls()) == {}
    assert control_steps(Controls(auto_exposure=True)) == {Control.AUTO_EXPOSURE: 3}


def test_a_mains_of_55_hz_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"55 Hz.*50, 60"):
        Controls(power_line_hz=55)


def test_a_node_without_controls_has_none_and_an_absent_one_is_unavailable(tmp_path: Path) -> None:
    plain = tmp_path / "video0"
    plain.touch()
    assert NodeControls(plain).range(Control.GAIN) is None
    assert NodeControls(plain).read(Control.GAIN) is None
    assert NodeControls(plain).write(Control.GAIN, 3) is None
    with pytest.raises(UnavailableError):
        NodeControls(tmp_path / "video9").read(Control.GAIN)


@pytest.mark.parametrize("code", [errno.EBUSY, errno.ETIMEDOUT, errno.EREMOTE, errno.EPROTO])
def test_a_control_that_does_not_answer_keeps_no_camera_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    """uvcvideo passes a camera's "not ready" on as EBUSY, and its silence as ETIMEDOUT."""
    node = tmp_path / "video0"
    node.touch()

    def refuse(*_: object) -> bytes:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr("mocapd.capture.webcam.v4l2_ioctl.fcntl.ioctl", refuse)
    (result,) = apply_controls(NodeControls(node), Controls(gain=3))
    assert (result.control, result.got) == (Control.GAIN, None)
    assert NodeControls(node).range(Control.GAIN) is None
    code = errno.ENODEV
    with pytest.raises(UnavailableError, match="unplugged"):
        apply_controls(NodeControls(node), Controls(gain=3))


def test_asking_for_controls_leaves_no_descriptor_open(tmp_path: Path) -> None:
    plain = tmp_path / "video0"
    plain.touch()
    before = len(list(Path("/proc/self/fd").iterdir()))
    NodeControls(plain).read(Control.GAIN)
    assert len(list(Path("/proc/self/fd").iterdir())) == before


VGA, SMALL = (640, 480), (320, 240)
YUYV = tuple(PixelFormat("YUYV", size, (30.0, 15.0)) for size in (VGA, SMALL))


def speed(sysfs: Path, port: str, text: str) -> None:
    folder = sysfs / "bus/usb/devices" / port
    folder.mkdir(parents=True)
    (folder / "speed").write_text(f"{text}\n")


def test_two_uncompressed_cameras_do_not_fit_on_usb_2_but_compressed_ones_do(
    tmp_path: Path,
) -> None:
    yuyv, mjpg = Mode("YUYV", VGA, 30.0), Mode("MJPG", VGA, 30.0)
    assert yuyv.bytes_per_s == 640 * 480 * 2 * 30
    (bus,) = crowded_buses({"a": ("1-1", yuyv), "b": ("1-2.3", yuyv)}, tmp_path)
    assert (bus.bus, bus.cameras) == ("1", ("a", "b"))
    assert crowded_buses({"a": ("1-1", yuyv), "b": ("2-1", yuyv)}, tmp_path) == ()
    assert crowded_buses({"a": ("1-1", mjpg), "b": ("1-2", mjpg)}, tmp_path) == ()


def test_the_speed_of_the_bus_is_read(tmp_path: Path) -> None:
    for port, text in (("1-1", "480"), ("2-1", "5000"), ("3-1", "12"), ("4-1", "1.5")):
        speed(tmp_path, port, text)
    usable = [usable_bytes_per_s(port, tmp_path) for port in ("1-1", "2-1", "3-1", "4-1", "9-9")]
    assert usable[2] == usable[3] < usable[0] == usable[4] < usable[1]
    fast = Mode("YUYV", VGA, 30.0)
    assert crowded_buses({"a": ("2-1", fast), "b": ("2-2", fast)}, tmp_path / "none")
    speed(tmp_path, "2-2", "5000")
    assert crowded_buses({"a": ("2-1", fast), "b": ("2-2", fast)}, tmp_path) == ()


def test_a_lower_mode_fits_and_is_the_best_that_does() -> None:
    asked = Mode("YUYV", VGA, 30.0)
    assert lower_mode(YUYV, asked, 18e6) == Mode("YUYV", SMALL, 30.0)
    assert lower_mode(YUYV, asked, 3e6) == Mode("YUYV", SMALL, 15.0)
    assert lower_mode(YUYV, asked, 1e6) is None
    assert lower_mode((*YUYV, PixelFormat("YUYV", VGA, (25.0,))), asked, 18e6) == Mode(
        "YUYV", VGA, 25.0
    )
    both = (*YUYV, PixelFormat("MJPG", VGA, (30.0, 20.0)))
    assert lower_mode(both, Mode("MJPG", VGA, 30.0), 3e6) == Mode("MJPG", VGA, 20.0)


@pytest.mark.parametrize(
    ("low", "high", "is_there"), [(3, 2047, True), (3, 3, False), (9, 2, False)]
)
def test_a_range_without_a_choice_is_that_of_a_control_that_cannot_be_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, low: int, high: int, is_there: bool
) -> None:
    """Else a node refuses each value: "takes 9 to 2, not 5"."""
    plain = tmp_path / "video0"
    plain.touch()
    answer = v4l2_ioctl._QUERYCTRL.pack(0, 1, b"Exposure", low, high, 1, low, 0, 0, 0)
    monkeypatch.setattr(fcntl, "ioctl", lambda *_: answer)
    assert (NodeControls(plain).range(Control.EXPOSURE) is not None) == is_there
