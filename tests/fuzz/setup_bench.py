"""A real wizard with all its steps, over two webcams that are not there, for messages of a page."""

import shutil
import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from mocapd.boundary.parsing import decode_json
from mocapd.calibration.calibration_record import Calibration
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.webcam.identity import parse_identity
from mocapd.capture.webcam.v4l2_ioctl import PixelFormat
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.clock import monotonic_ns
from mocapd.config.sections import TrackerSection
from mocapd.errors import CannotCreateError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.types import Frame
from mocapd.web.links.wizard_link import PageCommand
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.same_port import PortChange
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.check.check_step import CheckStep
from mocapd.wizard.check.check_tracking import CheckTracker
from mocapd.wizard.colour.colour_step import ColourStep
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.step import Json, Tell
from mocapd.wizard.step_names import StepName
from mocapd.wizard.steps import SetupCameras, all_steps
from mocapd.wizard.wizard import Wizard
from mocapd.wizard.wizard_view import WizardView
from tests.fuzz.row import DeadlyError
from tests.wizard.drafts import NAMES, PORTS, SIZE_PX, full_draft, source_of
from tests.wizard.fake_webcam import FakeWebcam

_PATIENCE_S = 3.0
_ANSWER_S = 0.02


class CountingWizard(Wizard):
    """Knows how many commands it was sent."""

    sent = 0

    def send(self, verb: str, args: Mapping[str, Json] | None = None) -> None:
        """See Wizard."""
        self.sent += 1
        super().send(verb, args)


class SetupBench:
    """One setup, from its beginning to `close`. Every step is done in its draft but Colour, and no tracker can be loaded, so
    nothing heavy is begun. The cameras show grey, and a new picture before every command. Its files are in a folder of its
    own within `folder`."""

    def __init__(self, folder: Path, step: StepName = StepName.CAMERAS) -> None:
        self.deaths: list[BaseException] = []
        self._folder = Path(tempfile.mkdtemp(dir=folder))
        self.hub = FrameHub(NAMES)
        self._seq = 0
        draft = replace(full_draft(), colours={}, personal=False)
        self._locks = CameraLocks([FakeWebcam(name) for name in NAMES])
        cameras = SetupCameras(
            draft.cameras,
            lambda: tuple(_node(name) for name in NAMES),
            self._locks,
            (PortChange("cam1", source_of("cam1", "1-9"), source_of("cam1", PORTS["cam1"])),),
        )
        settings, shown = CheckSettings(TrackerSection()), NewestBody()
        steps = dict(all_steps(cameras, settings, shown, self.deaths.append))
        steps[StepName.COLOUR] = partial(ColourStep, load=_no_database)
        steps[StepName.CHECK] = partial(
            CheckStep,
            settings=settings,
            shown=shown,
            died=self.deaths.append,
            load=_no_tracker,
        )
        self.wizard = CountingWizard(
            self.hub,
            steps,
            self._statuses,
            self._folder,
            self._folder,
            self.deaths.append,
            first=step,
            draft=draft,
        )
        self.show()
        self.wizard.start()
        self.newer(0)

    def show(self) -> None:
        """Each camera has a new picture."""
        self._seq += 1
        for name in NAMES:
            pixels = np.full((SIZE_PX[1], SIZE_PX[0], 3), 110, np.uint8)
            self.hub.put(Frame(name, self._seq, monotonic_ns(), pixels))

    def do(self, message: bytes) -> bool:
        """A message of the page: whether it was taken, and not refused.

        Raises MalformedError, and DeadlyError when it ended the setup, at once or at the next tick.
        """
        command = decode_json(message, PageCommand)
        self.show()
        before = self.wizard.view().serial
        self.wizard.send(command.verb, command.args)
        answer = self.newer(before)
        view = self.newer(answer.serial)  # after a tick
        until_s = time.monotonic() + _PATIENCE_S
        while self.wizard.job is not None and view.step is not StepName.CAMERAS:
            view = self.newer(view.serial)
            if time.monotonic() > until_s:
                break
        return answer.refused is None

    def newer(self, than: int) -> WizardView:
        """The view after `than`. Raises DeadlyError when there will be none."""
        until_s = time.monotonic() + _PATIENCE_S
        while True:
            view = self.wizard.newer(than, _ANSWER_S)
            if self.deaths:
                raise DeadlyError(self.deaths[0])
            if view.serial > than:
                return view
            assert time.monotonic() < until_s, "the setup says nothing"

    def close(self) -> None:
        """End it, without waiting for its next tick."""
        self.wizard.stop(0.0)
        self.wizard.send("wake up")
        self.wizard.stop(1.0)
        self._locks.restore()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _statuses(self) -> Mapping[str, CaptureStatus]:
        return {
            name: CaptureStatus(name, CaptureState.LIVE, "", self._seq, 0, 0, 30.0, monotonic_ns())
            for name in NAMES
        }


def _no_database(cache_dir: Path, tell: Tell) -> PoseDatabase:
    """It takes a minute to make."""
    raise CannotCreateError("the cache cannot be written", str(cache_dir), "make room")


def _no_tracker(
    known: Calibration, settings: CheckSettings, cache_dir: Path, tell: Tell
) -> CheckTracker:
    """It takes seconds and much memory, in a thread."""
    raise CannotCreateError("the cache cannot be written", str(cache_dir), "make room")


def _node(name: str) -> CameraInfo:
    identity = parse_identity(source_of(name, PORTS[name]))
    formats = (PixelFormat("MJPG", SIZE_PX, (30.0, 15.0)), PixelFormat("YUYV", (640, 480), (30.0,)))
    return CameraInfo(
        Path("/dev/video0"), "Cam", identity, source_of(name, PORTS[name]), formats, "", ""
    )
