"""What is asked of a webcam and read back, its buffers as pictures, its measured rate."""

import resource
import tracemalloc
from contextlib import nullcontext
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.capture.camera_thread.rate import RateMeter
from mocapd.capture.webcam import v4l2
from mocapd.capture.webcam.v4l2 import WebcamSettings, decode, negotiate
from mocapd.errors import ConfigError, UnavailableError
from mocapd.types import Bytes, Frame
from tests.capture.films import number_of, picture, taken_upright

SIZE_PX = (64, 48)


def jpeg(index: int) -> Bytes:
    return np.asarray(cv2.imencode(".jpg", picture(index))[1], dtype=np.uint8)


def taken(buffer: Bytes, fourcc: str = "MJPG", reduced_by: int = 1) -> Frame | None:
    picture = decode(buffer, fourcc, SIZE_PX, reduced_by)
    return None if picture is None else Frame("a", 0, 0, picture)


def test_a_whole_jpeg_is_decoded_whatever_the_shape_of_the_buffer() -> None:
    for buffer in (jpeg(77), jpeg(77).reshape(1, -1), np.append(jpeg(77), np.zeros(99, np.uint8))):
        frame = taken(buffer)
        assert frame is not None
        assert frame.pixels.shape == (48, 64, 3)
        assert not frame.pixels.flags.writeable
        assert number_of(frame.pixels) == 77


@pytest.mark.parametrize("reduced_by", [1, 2])
def test_its_file_outlives_the_drivers_buffer(reduced_by: int) -> None:
    buffer = jpeg(77).reshape(1, -1).copy()
    frame = taken(buffer, reduced_by=reduced_by)
    assert frame is not None
    buffer[:] = 0  # the driver writes the next picture
    assert frame.encoded == jpeg(77).tobytes()
    assert number_of(frame.pixels) == 77


@pytest.mark.parametrize("reduced_by", [1, 2])
def test_a_file_that_takes_more_than_its_pixels_is_not_kept(reduced_by: int) -> None:
    stuffed = np.append(jpeg(77), np.zeros(64 * 48 * 3, np.uint8))
    frame = taken(stuffed, reduced_by=reduced_by)
    assert frame is not None
    assert frame.encoded is None
    assert number_of(frame.pixels) == 77


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.95])
def test_a_cut_jpeg_is_torn(part: float) -> None:
    whole = jpeg(5)
    assert decode(whole[: int(part * whole.size)], "MJPG", SIZE_PX) is None


def test_a_picture_of_another_size_is_torn() -> None:
    assert decode(jpeg(5), "MJPG", (640, 480)) is None


def test_a_header_of_a_huge_picture_is_torn_before_memory_is_taken() -> None:
    huge = bytearray(jpeg(5).tobytes())
    frame = huge.index(b"\xff\xc0") + 5  # height and width
    huge[frame : frame + 4] = (32_000).to_bytes(2, "big") * 2
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert decode(np.frombuffer(huge, dtype=np.uint8), "MJPG", SIZE_PX) is None
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000  # [kB]


def test_a_picture_that_is_turned_by_its_own_word_is_torn() -> None:
    turned = np.frombuffer(taken_upright(jpeg(5).tobytes()), dtype=np.uint8)
    assert decode(turned, "MJPG", SIZE_PX) is None
    assert decode(turned, "MJPG", SIZE_PX, 2) is None


def test_yuyv_is_converted_and_a_short_buffer_is_torn() -> None:
    buffer = cv2.cvtColor(picture(9), cv2.COLOR_BGR2YUV_YUY2)
    frame = taken(np.asarray(buffer, np.uint8), "YUYV")
    assert frame is not None
    assert number_of(frame.pixels) == 9
    assert decode(buffer.reshape(-1)[:-2], "YUYV", SIZE_PX) is None


class StubbornCamera:
    """Takes values as the UVC cameras measured do: says yes to all, and clips."""

    def __init__(self, fourcc: str = "MJPG", unplugged: bool = False) -> None:
        self.asked: list[int] = []
        self._unplugged = unplugged
        self.held = {
            cv2.CAP_PROP_FOURCC: float(cv2.VideoWriter.fourcc(*fourcc)),
            cv2.CAP_PROP_FRAME_WIDTH: 640.0,
            cv2.CAP_PROP_FRAME_HEIGHT: 480.0,
            cv2.CAP_PROP_FPS: 30.0,
            cv2.CAP_PROP_BUFFERSIZE: 4.0,
        }
        self._limits = {
            cv2.CAP_PROP_FRAME_WIDTH: 640.0,
            cv2.CAP_PROP_FRAME_HEIGHT: 480.0,
            cv2.CAP_PROP_FPS: 30.0,
        }

    def set(self, property_id: int, value: float) -> bool:
        self.asked.append(property_id)
        if property_id in self.held and property_id != cv2.CAP_PROP_FOURCC:  # it has only one
            self.held[property_id] = min(value, self._limits.get(property_id, value))
        return not self._unplugged

    def get(self, property_id: int) -> float:
        return -1.0 if self._unplugged else self.held.get(property_id, -1.0)


NODE = Path("/dev/video0")


class DroppingCamera(StubbornCamera):
    """Delivers pictures of the numbers given, of thirty a second, with the driver's stamps; at once."""

    def __init__(self, numbers: list[int]) -> None:
        super().__init__()
        self._numbers = numbers
        self.now_ms = 0.0

    def isOpened(self) -> bool:
        return True

    def grab(self) -> bool:
        self.now_ms = 1000.0 + 1000.0 / 30.0 * self._numbers.pop(0)
        return True

    def get(self, property_id: int) -> float:
        return self.now_ms if property_id == cv2.CAP_PROP_POS_MSEC else super().get(property_id)

    def retrieve(self) -> tuple[bool, Bytes]:
        return True, np.asarray(cv2.imencode(".jpg", np.zeros((480, 640, 3), np.uint8))[1])

    def release(self) -> None:
        """Nothing is held."""


def test_a_picture_that_never_came_is_a_gap_in_the_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = [*range(20), 22, 23]  # the driver's count of them is not to be had from OpenCV
    camera = DroppingCamera(list(numbers))
    monkeypatch.setattr(cv2, "VideoCapture", lambda *_: camera)
    monkeypatch.setattr(v4l2, "opened_node", lambda _: nullcontext(-1))
    monkeypatch.setattr(v4l2, "check_usable", lambda *_: None)
    monkeypatch.setattr(v4l2, "monotonic_ns", lambda: round(1e6 * (camera.now_ms + 20.0)))
    source = v4l2.V4l2Source("left", NODE)
    source.open()
    assert [source.read().seq for _ in numbers] == numbers


def test_the_format_is_asked_for_before_the_size_and_the_size_before_the_rate() -> None:
    camera = StubbornCamera()
    got = negotiate(camera, WebcamSettings(), "left", NODE, moved=False)
    assert camera.asked[:4] == [
        cv2.CAP_PROP_FOURCC,
        cv2.CAP_PROP_FRAME_WIDTH,
        cv2.CAP_PROP_FRAME_HEIGHT,
        cv2.CAP_PROP_FPS,
    ]
    assert (got.fourcc, got.size_px, got.fps_hz) == ("MJPG", (640, 480), 30.0)
    assert camera.held[cv2.CAP_PROP_BUFFERSIZE] == 1.0


def test_what_is_read_back_counts_and_not_what_was_asked() -> None:
    asked = WebcamSettings(fps_hz=60.0)
    assert negotiate(StubbornCamera(), asked, "left", NODE, moved=False).fps_hz == 30.0
    yuyv = negotiate(StubbornCamera("YUYV"), WebcamSettings(), "left", NODE, moved=False)
    assert yuyv.fourcc == "YUYV"


def test_a_webcam_that_does_not_give_the_calibrated_size_is_a_config_error() -> None:
    asked = WebcamSettings(size_px=(1280, 720))
    with pytest.raises(ConfigError, match=r"640x480.*'left'.*1280x720"):
        negotiate(StubbornCamera(), asked, "left", NODE, moved=False)


def test_a_webcam_unplugged_while_it_is_opened_is_sought_again() -> None:
    with pytest.raises(UnavailableError, match="unplugged"):
        negotiate(StubbornCamera(unplugged=True), WebcamSettings(), "left", NODE, moved=False)


def test_a_webcam_of_another_format_is_refused() -> None:
    with pytest.raises(UnavailableError, match="'GREY'"):
        negotiate(StubbornCamera("GREY"), WebcamSettings(), "left", NODE, moved=False)


def test_the_rate_is_that_of_the_last_seconds() -> None:
    meter = RateMeter(window_s=2.0)
    assert meter.rate_hz() == 0.0
    for index in range(100):
        meter.add(index * 40_000_000)
    assert meter.full
    assert meter.rate_hz() == pytest.approx(25.0)
    for index in range(30):
        meter.add(4_000_000_000 + index * 100_000_000)
    assert meter.rate_hz() == pytest.approx(10.0)


def test_silence_lowers_the_rate_down_to_nothing() -> None:
    meter = RateMeter(window_s=2.0)
    for index in range(60):
        meter.add(index * 40_000_000)
    rates = [meter.rate_hz(silent_ns=ms * 1_000_000) for ms in (0, 40, 500, 1500, 2001, 3000)]
    assert rates[:2] == [pytest.approx(25.0)] * 2
    assert rates[2:4] == sorted(rates[2:4], reverse=True)
    assert rates[4:] == [0.0, 0.0]


@pytest.mark.parametrize("step_ns", [0, -1_000_000])
def test_stamps_that_do_not_advance_take_no_memory(step_ns: int) -> None:
    meter = RateMeter()
    for index in range(1_000):
        meter.add(index * step_ns)
    tracemalloc.start()
    for index in range(1_000, 100_000):
        meter.add(index * step_ns)
    grown, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert grown < 300_000
    assert meter.rate_hz() == 0.0


def test_a_cleared_meter_knows_no_rate() -> None:
    meter = RateMeter(window_s=1.0)
    for index in range(40):
        meter.add(index * 40_000_000)
    meter.clear()
    assert not meter.full
    assert meter.rate_hz() == 0.0
