"""The host of the page without a daemon: the cameras and the setup only."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from mocapd.capture.base import Source
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.errors import UnavailableError
from mocapd.latch import EndLatch
from mocapd.pipeline.body_hub import BodySample
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.service.service import Snapshot
from mocapd.types import Rig
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.same_port import PortChange
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.draft import Draft
from mocapd.wizard.hosts.open_cameras import OpenCameras
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.setup_keeper import SetupKeeper
from mocapd.wizard.step import Scene
from mocapd.wizard.step_names import StepName
from mocapd.wizard.steps import SetupCameras, all_steps, only
from mocapd.wizard.wizard import Wizard


class OwnHost:
    """A Host (see web.host) from `start` to `stop`, used by its owner; `ended` by any thread."""

    recordings = None  # a check of a few seconds is not recorded

    def __init__(
        self,
        draft: Draft,
        settings: CheckSettings,
        state_dir: Path,
        cache_dir: Path,
        step: StepName | None = None,
        sources: Mapping[str, Source] | None = None,
        scene: Callable[[Scene], object] | None = None,
        nodes: Callable[[], tuple[CameraInfo, ...]] = tuple,
        moved: tuple[PortChange, ...] = (),
    ) -> None:
        """draft: initial data, with the cameras to open; step: the only one to show, None for all of them;
        sources: existing sources of the draft's cameras by id; nodes: lists other plugged-in cameras; moved: see
        SetupCameras. Raises ConfigError or InputError."""
        if step is StepName.COLOUR:  # a calibration may say that there is no shirt
            draft = replace(draft, has_shirt=True)
        self._over = EndLatch()
        self._saved = threading.Event()
        self._cameras = OpenCameras(draft.cameras, self.on_thread_died, sources, settings.bundler)
        self._locks = CameraLocks(self._cameras.sources)
        self._shown = NewestBody()
        of_cameras = SetupCameras(draft.cameras, nodes, self._locks, moved)
        steps = all_steps(of_cameras, settings, self._shown, self.on_thread_died)
        self.wizard = Wizard(
            self._cameras.hub,
            steps if step is None else only(steps, step),
            self._cameras.statuses,
            state_dir,
            cache_dir,
            self.on_thread_died,
            scene=scene,
            first=step or StepName.CAMERAS,
            draft=draft,
            on_saved=self._saved.set,
            # a single step is not worth an offer, which would be of the whole setup
            keeper=SetupKeeper(state_dir, draft, self._locks) if step is None else None,
        )

    def start(self) -> None:
        """Begin; returns at once."""
        self._cameras.start()
        self.wizard.start()

    def stop(self) -> None:
        """End: the setup first, so that it restores the cameras' controls."""
        self.wizard.stop()
        self._locks.restore()
        self._cameras.stop()

    def on_thread_died(self, error: BaseException) -> None:
        """A thread raised an unexpected exception, so the process must end."""
        self._over.died(error)

    def end(self) -> None:
        """Make `wait` return; from any thread or a signal handler."""
        self._over.set()

    def wait(self, timeout_s: float) -> bool:
        """Whether it is over; also recovers stalled cameras, so call it several times a second. Raises the MocapdError
        that killed a thread, ThreadDiedError for anything else."""
        over = self._over.wait(timeout_s)
        self._cameras.watch()
        return over

    @property
    def is_saved(self) -> bool:
        return self._saved.is_set()

    # -- Host ------------------------------------------------------------------------------------

    @property
    def hub(self) -> FrameHub:
        return self._cameras.hub

    @property
    def rig(self) -> Rig | None:
        return self.wizard.draft.rig

    def known(self) -> RecordingMetadata:
        """See web.host.Host: there is no saved calibration yet."""
        return RecordingMetadata()

    def setup(self) -> Wizard:
        return self.wizard

    def body(self) -> BodySample | None:
        return self._shown.bodies.newest()

    def recenter(self) -> None:
        raise UnavailableError("no output runs here", "the setup", "start `mocapd run`")

    def snapshot(self) -> Snapshot | None:
        loop = self._shown.loop
        if loop is None:
            return None
        return Snapshot(loop.metrics(), dict(self._cameras.statuses()), {})
