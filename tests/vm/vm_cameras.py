"""The step Cameras against a real uvcvideo driver: runs in the guest of ../shared/vm, not under pytest.

Like tests/vm/vm_proof.py (see docs/webcams.md for the machine); needs mocapd's packages capture,
calibrate, pipeline and wizard beside it.

    python vm_cameras.py lock | sigterm | replug | yuyv | reasons
"""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import logging
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.webcam.v4l2 import V4l2Source, WebcamSettings
from mocapd.capture.webcam.webcam_listing import list_cameras
from mocapd.capture.webcam.webcams import capture_nodes
from mocapd.clock import monotonic_ns
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.cameras_step import CamerasStep
from mocapd.wizard.draft import DraftCamera
from mocapd.wizard.step import StepState
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import Wizard
from mocapd.wizard.wizard_view import WizardView

CAM = "/mnt/share/rig/cam.sh"
BEGAN_NS = monotonic_ns()
SHOWN = (
    "auto_exposure,exposure_time_absolute,exposure_dynamic_framerate,gain,white_balance_automatic,"
    "white_balance_temperature,focus_automatic_continuous,focus_absolute,power_line_frequency"
)


def say(*words: object) -> None:
    print(f"[{(monotonic_ns() - BEGAN_NS) / 1e9:7.3f}]", *words, flush=True)


def rig(*words: str) -> None:
    done = subprocess.run(["bash", CAM, *words], capture_output=True, text=True, check=False)
    say(">>", *words, "->", (done.stdout + done.stderr).strip() or "done")


def show_controls(when: str, node: str = "/dev/video0") -> None:
    done = subprocess.run(
        ["v4l2-ctl", "-d", node, "-C", SHOWN], capture_output=True, text=True, check=False
    )
    pairs = (line.split(": ", 1) for line in done.stdout.splitlines() if ": " in line)
    say(when, "|", " ".join(f"{name}={value}" for name, value in pairs))


@contextmanager
def setup() -> Iterator[Wizard]:
    """The wizard with its first step, on all webcams of the machine, as its host does it."""
    identities = tuple(capture_nodes())
    settings = WebcamSettings()
    sources = [
        V4l2Source(f"cam{i}", one, settings, tuple(other for other in identities if other != one))
        for i, one in enumerate(identities)
    ]
    cameras = tuple(
        DraftCamera(f"cam{i}", str(one), settings.size_px) for i, one in enumerate(identities)
    )
    hub = FrameHub([source.name for source in sources])
    threads = {
        source.name: CaptureThread(source, hub, lambda error: say("died", error), 30.0)
        for source in sources
    }
    locks = CameraLocks(sources)
    wizard = Wizard(
        hub,
        {StepName.CAMERAS: lambda context: CamerasStep(context, cameras, list_cameras, locks)},
        lambda: {name: one.status() for name, one in threads.items()},
        Path("/tmp"),
        Path("/tmp"),
        lambda error: say("wizard died", repr(error)),
    )
    for one in threads.values():
        one.start()
    wizard.start()
    try:
        yield wizard
    finally:
        wizard.stop()
        locks.restore()
        for one in threads.values():
            one.stop()


def until(wizard: Wizard, what: str, is_so: Callable[[WizardView], bool]) -> WizardView:
    deadline = time.monotonic() + 40.0
    view = wizard.view()
    while not is_so(view) and time.monotonic() < deadline:
        view = wizard.newer(view.serial, 1.0)
    say(f"{what}:", view.view.state, "|", view.view.sentence)
    for problem in view.view.problems:
        say("   problem", problem.where, "|", problem.what, "|", problem.fix)
    return view


def done(view: WizardView) -> bool:
    return view.view.state is StepState.DONE


def rows(view: WizardView) -> list[dict[str, object]]:
    found = view.view.details["cameras"]
    assert isinstance(found, list)
    return found


def step_lock() -> None:
    show_controls("before")
    with setup() as wizard:
        until(wizard, "settling", lambda view: bool(rows(view)[0]["phase"] == "settling"))
        view = until(wizard, "done", done)
        show_controls("locked")
        say(rows(view)[0]["controls"])
        rates = [(row["id"], row["measured_hz"]) for row in rows(view)]
        say("rates", rates)
    show_controls("after")


def step_sigterm() -> None:
    """This process in a child, which is told to end while its cameras are locked."""
    show_controls("before")
    child = subprocess.Popen([sys.executable, __file__, "hold"])
    time.sleep(12.0)
    show_controls("held by the child")
    child.send_signal(signal.SIGTERM)
    say("child ended with", child.wait(10.0))
    show_controls("after SIGTERM")


def step_hold() -> None:
    over = threading.Event()

    def end(_number: int, _frame: FrameType | None) -> None:
        over.set()

    signal.signal(signal.SIGTERM, end)
    with setup() as wizard:
        until(wizard, "the child's cameras", done)
        over.wait(30.0)


def step_replug() -> None:
    with setup() as wizard:
        until(wizard, "done", done)
        rig("unplug", "0")
        until(wizard, "unplugged", lambda view: view.view.state is StepState.WAITING)
        time.sleep(1.0)
        rig("plug", "0")
        until(wizard, "back", done)
        show_controls("a replugged camera")


def step_yuyv() -> None:
    """Two webcams without a film have no MJPG, on the one USB bus of the guest."""
    for n in ("0", "1"):
        rig("unplug", n)
    for n in ("2", "3"):
        rig("plug", n)
    with setup() as wizard:
        view = until(wizard, "crowded", lambda view: bool(view.view.problems) and done(view))
        for row in rows(view):
            say(row["id"], row["measured_hz"], "Hz, offer", row["offer"])
        offer = rows(view)[0]["offer"]
        if isinstance(offer, dict):
            wizard.send("mode", {"camera": "cam0", **offer})
            until(wizard, "changing", lambda view: not done(view))
            view = until(wizard, "in the lower mode", done)
            for row in rows(view):
                say(row["id"], row["size_px"], row["fps_hz"], "asked,", row["measured_hz"], "Hz")
    for n in ("2", "3"):
        rig("unplug", n)
    for n in ("0", "1"):
        rig("plug", n)


def step_reasons() -> None:
    """What the step lists of cameras that it cannot have."""
    with setup() as wizard:
        view = until(wizard, "view", lambda view: bool(view.view.details["others"]) or done(view))
        say(view.view.details["others"])
        for row in rows(view):
            say(row["id"], row["phase"], row["problems"])


STEPS: dict[str, Callable[[], None]] = {
    name.removeprefix("step_"): value
    for name, value in globals().copy().items()
    if name.startswith("step_")
}

if __name__ == "__main__":
    logging.basicConfig(level=logging.WARNING, format="            log %(levelname)s %(message)s")
    STEPS[sys.argv[1]]()
