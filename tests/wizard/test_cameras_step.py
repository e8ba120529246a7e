"""The step Cameras with simulated webcams: settling, locking, trouble, and what the person may do."""

from dataclasses import replace
from pathlib import Path

import pytest

from mocapd.capture.webcam.camera_controls import Control
from mocapd.capture.webcam.controls import Controls
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.v4l2_ioctl import PixelFormat
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.errors import InputError
from mocapd.pipeline.other_programs import OtherPrograms
from mocapd.types import Frame
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.cameras_step import CamerasStep
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.step import StepState, StepView
from tests.wizard.context import FakeContext, do
from tests.wizard.fake_webcam import FACTORY, FakeWebcam

FRAME_NS = 33_333_333


class Bench:
    """Webcams, their step, and time that passes by frames."""

    def __init__(
        self, folder: Path, *webcams: FakeWebcam, nodes: tuple[CameraInfo, ...] = ()
    ) -> None:
        self.webcams = {webcam.name: webcam for webcam in webcams}
        self.cameras = tuple(
            DraftCamera(name, f"usb:1-{i + 1}:046d:0825:S{i}", (640, 480))
            for i, name in enumerate(self.webcams)
        )
        self.context = FakeContext(folder, Draft(cameras=self.cameras))
        self.locks = CameraLocks(webcams)
        self.nodes = nodes
        self.busy, self.others = 0.1, 0.0  # shares of the processors
        self._read_s = (0.0, 0.0, 0.0)
        self.enter()

    def enter(self) -> None:
        load = OtherPrograms(self._load)
        self.step = CamerasStep(self.context, self.cameras, lambda: self.nodes, self.locks, load)
        self.step.enter()

    def _load(self) -> tuple[float, float, float]:
        total_s, busy_s, own_s = self._read_s
        self._read_s = (
            total_s + 2.0,
            busy_s + 2.0 * self.busy,
            own_s + 2.0 * (self.busy - self.others),
        )
        return self._read_s

    def run(self, seconds: float) -> StepView:
        for _ in range(round(seconds * 30)):
            for name, webcam in self.webcams.items():
                if name not in self.context.lost:
                    self.context.put(name, webcam.picture(self.context.now_ns))
            self.step.tick(self.context.now_ns)
            self.context.run_job(self.step)
            self.context.now_ns += FRAME_NS
        return self.step.view()

    def until_done(self, longest_s: float = 20.0) -> StepView:
        for _ in range(round(4 * longest_s)):
            view = self.run(0.25)
            if view.state is StepState.DONE:
                return view
        raise AssertionError(f"not done after {longest_s} s: {self.step.view()}")

    def controls(self, name: str) -> Controls:
        return next(one.controls for one in self.context.draft.cameras if one.id == name)


def test_webcams_settle_for_two_seconds_and_are_locked_as_they_were(tmp_path: Path) -> None:
    bench = Bench(tmp_path, left := FakeWebcam("left"), FakeWebcam("right"))
    bench.run(1.0)
    assert left.values[Control.AUTO_EXPOSURE] == 3
    assert left.values[Control.DYNAMIC_FRAMERATE] == 0
    before = left.picture(0).mean()
    view = bench.until_done()
    assert left.values[Control.AUTO_EXPOSURE] == 1
    assert left.values[Control.AUTO_WB] == left.values[Control.AUTOFOCUS] == 0
    assert left.picture(0).mean() == pytest.approx(before, rel=0.1)
    assert view.problems == ()
    assert "2 cameras are ready" in view.sentence
    controls = bench.controls("left")
    assert controls.exposure == left.values[Control.EXPOSURE]
    assert (controls.auto_exposure, controls.auto_wb, controls.autofocus) == (False, False, False)
    assert controls.dynamic_framerate is False
    assert left.settings.controls == controls  # set again after a replug


def test_a_camera_that_hides_its_automatic_exposure_is_searched_by_brightness(
    tmp_path: Path,
) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam", light=0.15, tells=False))
    bench.run(1.0)
    before = webcam.picture(0).mean()
    view = bench.until_done()
    assert webcam.picture(0).mean() == pytest.approx(before, rel=0.1)
    assert webcam.values[Control.EXPOSURE] != FACTORY[Control.EXPOSURE]
    assert webcam.values[Control.EXPOSURE] <= 333  # never longer than a frame
    assert not any("changed" in one.what for one in view.problems)


def test_everything_is_given_back_at_the_end(tmp_path: Path) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam"))
    webcam.values |= {Control.AUTO_WB: 0, Control.WB_TEMPERATURE: 5200, Control.GAIN: 20}
    before = dict(webcam.values)
    asked = webcam.settings
    bench.until_done()
    bench.step.leave()
    bench.enter()  # the first state counts, not that of the second time
    bench.until_done()
    bench.step.leave()
    assert webcam.values != before
    bench.locks.restore()
    bench.locks.restore()
    assert {**webcam.values, Control.EXPOSURE: 0} == {**before, Control.EXPOSURE: 0}
    assert webcam.settings == asked


def test_nothing_is_locked_after_the_end(tmp_path: Path) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam"))
    bench.run(1.0)
    bench.locks.restore()
    view = bench.run(4.0)
    assert webcam.values[Control.AUTO_EXPOSURE] == 3
    assert view.state is not StepState.DONE


def test_lamps_on_the_mains_are_met_by_an_exposure_of_whole_pulses(tmp_path: Path) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam", light=1.0, pulses_hz=100.0))
    webcam.values[Control.POWER_LINE] = 2
    bench.run(1.0)
    before = webcam.picture(0).mean()
    view = bench.until_done()
    assert webcam.values[Control.EXPOSURE] % 100 == 0
    assert webcam.values[Control.POWER_LINE] == 1
    assert bench.controls("cam").power_line_hz == 50
    assert webcam.picture(0).mean() == pytest.approx(before, rel=0.25)
    assert view.problems == ()


def test_flicker_in_light_too_bright_for_whole_pulses_is_said(tmp_path: Path) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam", light=9.0, pulses_hz=100.0))
    bench.until_done()
    view = bench.run(2.5)
    assert webcam.values[Control.EXPOSURE] < 50  # a hundred would be white
    assert [one.what.split(":")[0] for one in view.problems] == [
        "lamps flicker with the mains (50 Hz)"
    ]
    assert "dim the lamps" in view.problems[0].fix


def test_a_dark_room_is_said_and_one_may_go_on(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("cam", light=0.01))
    view = bench.until_done()
    bench.run(1.0)
    assert "too dark" in " ".join(one.what for one in bench.step.view().problems)
    assert view.state is StepState.DONE


def test_one_camera_is_allowed_and_told_what_it_cannot(tmp_path: Path) -> None:
    view = Bench(tmp_path, FakeWebcam("cam")).until_done()
    assert "One camera is ready" in view.sentence
    assert "guess" in view.sentence


def test_a_camera_unplugged_meanwhile_is_said_and_the_step_goes_on_when_it_is_back(
    tmp_path: Path,
) -> None:
    bench = Bench(tmp_path, FakeWebcam("left"), right := FakeWebcam("right"))
    bench.run(1.0)
    right.plugged = False
    bench.context.lost["right"] = "right: was unplugged -- plug it in again"
    view = bench.run(4.0)
    assert view.state is StepState.WAITING
    assert "right" in view.sentence
    problem = next(one for one in view.problems if one.where == "right")
    assert (problem.what, problem.fix) == ("right: was unplugged", "plug it in again")
    right.plugged = True
    right.values = dict(FACTORY)
    bench.context.lost.clear()
    bench.until_done()
    assert right.values[Control.AUTO_EXPOSURE] == 1


def test_unplugged_between_the_status_and_the_question(tmp_path: Path) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam"))
    bench.run(0.5)
    webcam.plugged = False
    view = bench.run(3.0)
    assert view.state is StepState.WORKING
    assert view.problems
    webcam.plugged = True
    bench.until_done()
    assert bench.step.view().problems == ()


def test_a_camera_can_be_left_out_and_taken_in_again(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("left"), FakeWebcam("right"))
    bench.context.lost["right"] = "busy: used by pid 4711 (cheese) -- end that program"
    bench.run(3.0)
    do(bench.step, "leave_out", {"camera": "right"})
    bench.until_done()
    assert [one.id for one in bench.context.draft.cameras] == ["left"]
    with pytest.raises(InputError, match="one camera must stay"):
        do(bench.step, "leave_out", {"camera": "left"})
    bench.context.lost.clear()
    do(bench.step, "take_in", {"camera": "right"})
    bench.until_done()
    assert [one.id for one in bench.context.draft.cameras] == ["left", "right"]


def test_who_was_left_out_stays_so_when_the_step_is_shown_again(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("left"), FakeWebcam("right"))
    do(bench.step, "leave_out", {"camera": "right"})
    bench.until_done()
    bench.step.leave()
    bench.enter()
    bench.until_done()
    assert [one.id for one in bench.context.draft.cameras] == ["left"]


def test_passwords_of_cameras_are_not_shown(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("left"))
    address = "rtsp://admin:hunter2@10.0.0.7/live?token=hunter2"
    (camera,) = bench.cameras
    bench.cameras = (replace(camera, source=address),)
    bench.context.draft = Draft(cameras=bench.cameras)
    bench.enter()
    shown = bench.run(0.2)
    assert "hunter2" not in str(shown)
    assert "10.0.0.7/live" in str(shown.details)


def test_a_camera_gets_a_name(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("left"), FakeWebcam("right"))
    do(bench.step, "name", {"camera": "left", "name": " by the window "})
    bench.until_done()
    assert bench.context.draft.cameras[0].label == "by the window"
    for wrong in ("x" * 41, "two\nlines", "right"):
        with pytest.raises(InputError):
            do(bench.step, "name", {"camera": "left", "name": wrong})
    with pytest.raises(InputError):
        do(bench.step, "name", {"camera": "nobody", "name": "x"})


def few_pictures(bench: Bench, lost: bool) -> str:
    """What is said after some seconds in which six pictures a second come. lost: the camera counted thirty."""
    (name,) = bench.webcams
    bench.context.rates_hz[name] = 6.0
    for index in range(150):
        if index % 5 == 0:
            pixels = bench.webcams[name].picture(bench.context.now_ns)
            seq = index if lost else index // 5
            bench.context.hub.put(Frame(name, seq, bench.context.now_ns, pixels))
        bench.step.tick(bench.context.now_ns)
        bench.context.run_job(bench.step)
        bench.context.now_ns += FRAME_NS
    (problem,) = bench.step.view().problems
    return f"{problem.what} -- {problem.fix}"


def yuyv_node(number: int) -> CameraInfo:
    identity = WebcamIdentity(f"1-{number + 1}", "046d", "0825", f"S{number}")
    formats = tuple(PixelFormat("YUYV", size, (30.0, 15.0)) for size in ((640, 480), (320, 240)))
    return CameraInfo(
        Path(f"/dev/video{2 * number}"), "Old Cam", identity, str(identity), formats, "", ""
    )


def test_two_uncompressed_cameras_on_one_bus_are_offered_a_lower_mode(tmp_path: Path) -> None:
    left, right = FakeWebcam("left"), FakeWebcam("right")
    bench = Bench(tmp_path, left, right, nodes=(yuyv_node(0), yuyv_node(1)))
    bench.context.lost["right"] = "right: cannot start: its USB bus has no room left -- other port"
    view = bench.run(3.0)
    crowded = next(one for one in view.problems if "USB bus 1" in one.what)
    assert "left and right" in crowded.what
    assert "lower mode" in crowded.fix
    rows = {row["id"]: row for row in view.details["cameras"]}  # type: ignore[attr-defined]
    offer = rows["right"]["offer"]
    assert offer == {"size_px": [320, 240], "fps_hz": 30.0}
    with pytest.raises(InputError, match="no mode"):
        do(bench.step, "mode", {"camera": "right", "size_px": [1280, 720], "fps_hz": 30.0})
    do(bench.step, "mode", {"camera": "right", **offer})
    assert (right.settings.size_px, right.opened) == ((320, 240), 1)
    bench.context.lost.clear()
    bench.until_done()
    assert bench.context.draft.cameras[1].size_px == (320, 240)


def test_few_pictures_are_blamed_on_usb_only_where_a_webcam_loses_them(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("cam"))
    bench.until_done()
    assert "USB" in few_pictures(bench, lost=True)
    assert "more light" in few_pictures(bench, lost=False), "it takes no more than that"
    bench.busy, bench.others = 1.0, 0.6
    for lost in (True, False):
        text = few_pictures(bench, lost)
        assert "this machine is too slow, other programs use 60 % of it" in text
        assert "close other programs" in text
        assert "USB" not in text
    bench.others = 0.1
    assert "its processors are 100 % busy" in few_pictures(bench, lost=True)
    bench.busy = 0.2
    assert "USB" in few_pictures(bench, lost=True), "the machine is free again"


@pytest.mark.parametrize(
    ("source", "says"),
    [
        ("sim:first_setup#cam0", "this machine is too slow"),
        ("rtsp://10.0.0.7/live", "network"),
        ("/dev/video0", "driver"),
    ],
)
def test_usb_is_not_blamed_for_cameras_that_are_not_on_usb(
    tmp_path: Path, source: str, says: str
) -> None:
    bench = Bench(tmp_path, FakeWebcam("cam"))
    bench.cameras = (replace(bench.cameras[0], source=source),)
    bench.context.draft = Draft(cameras=bench.cameras)
    bench.enter()
    bench.until_done()
    text = few_pictures(bench, lost=True)
    assert says in text
    assert "USB" not in text


def test_a_bus_on_which_all_run_well_is_not_complained_of(tmp_path: Path) -> None:
    bench = Bench(
        tmp_path, FakeWebcam("left"), FakeWebcam("right"), nodes=(yuyv_node(0), yuyv_node(1))
    )
    assert bench.until_done().problems == ()


def test_other_nodes_are_listed_with_their_reasons(tmp_path: Path) -> None:
    busy = CameraInfo(
        Path("/dev/video8"), "C270", None, "/dev/video8", (), "busy: used by pid 1 (x)", "end it"
    )
    metadata = CameraInfo(
        Path("/dev/video9"), "C270", None, "/dev/video9", (), "metadata", "", captures=False
    )
    ours = yuyv_node(0)
    bench = Bench(tmp_path, FakeWebcam("left"), nodes=(ours, busy, metadata))
    others = bench.run(1.0).details["others"]
    assert [row["node"] for row in others] == ["/dev/video8"]  # type: ignore[attr-defined]


def test_a_camera_of_three_pictures_a_second_is_locked_too(tmp_path: Path) -> None:
    bench = Bench(tmp_path, webcam := FakeWebcam("cam"))
    for index in range(450):
        if index % 10 == 0:
            bench.context.put("cam", webcam.picture(bench.context.now_ns))
        bench.step.tick(bench.context.now_ns)
        bench.context.run_job(bench.step)
        bench.context.now_ns += FRAME_NS
    assert bench.step.view().state is StepState.DONE
    assert webcam.values[Control.AUTO_EXPOSURE] == 1


def test_what_is_no_webcam_only_has_to_deliver(tmp_path: Path) -> None:
    bench = Bench(tmp_path, FakeWebcam("cam"))
    bench.locks = CameraLocks(())
    bench.enter()
    bench.run(1.5)
    assert bench.step.view().state is StepState.WORKING
    view = bench.run(1.0)
    assert view.state is StepState.DONE
    assert bench.controls("cam") == Controls()
