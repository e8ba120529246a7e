"""The host of the page in a daemon: its cameras and bodies, and a setup on demand."""

import logging
import threading
import time
from dataclasses import replace
from pathlib import Path

from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.calibration.calibration_record import ShirtColours
from mocapd.capture.kinds.source_kinds import is_simulated
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.capture.webcam.webcam_listing import list_cameras
from mocapd.capture.webcam.webcams import DEV, SYSFS, video_nodes
from mocapd.config.sections import Config
from mocapd.errors import MocapdError, UnavailableError
from mocapd.pipeline.body_hub import BodySample
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.service.body_recorder import BodyRecorder
from mocapd.service.recordings_folder import Recordings
from mocapd.service.service import Service, Snapshot
from mocapd.session.session import Session
from mocapd.types import Rig
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.same_port import PortChange, find_port_changes, same_camera
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.saving import load_draft
from mocapd.wizard.setup_keeper import SetupKeeper
from mocapd.wizard.steps import SetupCameras, all_steps
from mocapd.wizard.wizard import Wizard

FORGOTTEN_S = 120.0  # timeout of a setup that no page watches [s]
_SIZE_PX = (640, 480)  # of a camera that does not report one

_log = logging.getLogger(__name__)


class DaemonHost:
    """A Host (see web.host) over a service with any session; it must `rest` during a change of sessions.

    `saved`: set when a setup has saved its calibration.
    """

    def __init__(self, service: Service) -> None:
        self._service = service
        self.saved = threading.Event()
        self._lock = threading.Lock()  # guards the following
        self._resting = False
        self._wizard: Wizard | None = None
        self._locks: CameraLocks | None = None
        self._checked = NewestBody()  # of the setup's own tracker, during its step Check
        self._looked_s = 0.0
        self.recordings = Recordings(service.config.state_dir / "recordings", self._recorder)

    # -- the owner's -----------------------------------------------------------------------------

    def rest(self) -> None:
        """Called before the session ends: ends a setup on its cameras."""
        with self._lock:
            self._resting = True
        self._end_setup()

    def resume(self) -> None:
        """Called after a new session started."""
        with self._lock:
            self._resting = False

    def close(self) -> None:
        """Called before the service ends: completes a recording in progress."""
        try:
            self.recordings.close()
        except MocapdError as error:
            _log.warning("the page's recording: %s", error)

    def beat(self) -> None:
        """Called about once a second: an abandoned setup releases the cameras."""
        if self._wizard is not None and time.monotonic() - self._looked_s > FORGOTTEN_S:
            _log.info("the setup is ended: no page has looked at it for %g s", FORGOTTEN_S)
            self._end_setup()

    # -- Host ------------------------------------------------------------------------------------

    @property
    def hub(self) -> FrameHub:
        return self._service.hub

    @property
    def rig(self) -> Rig | None:
        wizard = self._wizard
        if wizard is not None and self._checked.loop is not None:
            return wizard.draft.rig
        return self._service.session.rig

    def known(self) -> RecordingMetadata:
        session = self._service.session
        shirt = session.calibration.shirt or ShirtColours()
        return RecordingMetadata(
            session.rig, session.shape.stature_m, shirt.model, shirt.white_balance
        )

    @property
    def wizard(self) -> Wizard | None:
        self._looked_s = time.monotonic()
        return self._wizard

    def setup(self) -> Wizard:
        with self._lock:
            if self._resting:
                raise UnavailableError(
                    "another session is about to begin", "the daemon", "try again in a few seconds"
                )
            if self._wizard is None:
                self._looked_s = time.monotonic()
                self._wizard = self._begun()
            return self._wizard

    def _recorder(self, path: Path) -> BodyRecorder:
        """A recorder of the service, for any session. Raises CannotCreateError."""
        return BodyRecorder(self._service.bodies, path, self.known(), self._service.instance)

    def recenter(self) -> None:
        self._service.recenter()

    def body(self) -> BodySample | None:
        bodies = self._checked.bodies if self._checked.loop is not None else self._service.bodies
        return bodies.newest()

    def snapshot(self) -> Snapshot:
        return self._service.snapshot()

    # -- the setup -------------------------------------------------------------------------------

    def _begun(self) -> Wizard:
        service, config, session = self._service, self._service.config, self._service.session
        self._locks = CameraLocks(camera.source for camera in session.cameras)
        state_dir = state_dir_of(config, session)
        cameras, draft = _with_what_was_saved(_cameras_of(session, config), state_dir)
        moved = _port_changes(draft)
        for change in moved:
            draft = same_camera(draft, change)
        sources = {camera.id: camera.source for camera in draft.cameras}
        cameras = tuple(replace(camera, source=sources[camera.id]) for camera in cameras)
        steps = all_steps(
            SetupCameras(cameras, list_cameras, self._locks, moved),
            CheckSettings(config.tracker, config.smoothing.preset, service.hub.bundler),
            self._checked,
            service.died,
        )
        wizard = Wizard(
            service.hub,
            steps,
            service.statuses,
            state_dir,
            config.cache_dir,
            service.died,
            draft=draft,
            on_saved=self.saved.set,
            keeper=SetupKeeper(state_dir, draft, self._locks),
        )
        wizard.start()
        return wizard

    def _end_setup(self) -> None:
        with self._lock:
            wizard, self._wizard = self._wizard, None
            locks, self._locks = self._locks, None
        if wizard is not None:
            wizard.stop(0.5)
        if locks is not None:
            locks.restore()


def state_dir_of(config: Config, session: Session) -> Path:
    """The directory for saving a setup; simulated cameras never replace a real calibration."""
    if session.rig_source == str(config.state_dir / FILE_NAME):
        return config.state_dir
    simulated = any(is_simulated(camera.address) for camera in session.cameras)
    return config.state_dir / "demo" if simulated else config.state_dir


def _cameras_of(session: Session, config: Config) -> tuple[DraftCamera, ...]:
    """The daemon's cameras in the form of a draft."""
    asked = {camera.id: camera for camera in config.camera}
    cameras = []
    for one in session.cameras:
        name = one.source.name
        size_px = one.size_px if any(one.size_px) else _SIZE_PX
        camera = DraftCamera(name, one.address, size_px, one.expected_hz or 30.0)
        if name in asked:
            camera = replace(camera, controls=asked[name].controls)
        cameras.append(camera)
    return tuple(cameras)


def _with_what_was_saved(
    cameras: tuple[DraftCamera, ...], state_dir: Path
) -> tuple[tuple[DraftCamera, ...], Draft]:
    """The cameras with their saved controls, and the saved calibration if it is of just these."""
    try:
        saved = load_draft(state_dir)
    except MocapdError as error:  # none yet, or a damaged one
        _log.info("the setup begins from nothing: %s", error)
        return cameras, Draft(cameras=cameras)
    before = {(camera.id, camera.source): camera for camera in saved.cameras}
    cameras = tuple(before.get((camera.id, camera.source), camera) for camera in cameras)
    if set(cameras) == set(saved.cameras):
        return cameras, replace(saved, cameras=cameras)
    # input of the user that need not be repeated
    return cameras, Draft(
        cameras=cameras, board=saved.board, stature_m=saved.stature_m, has_shirt=saved.has_shirt
    )


def _port_changes(draft: Draft) -> tuple[PortChange, ...]:
    """Cameras that the daemon itself identified at another port, for a question to the user."""
    nodes = video_nodes(SYSFS, DEV)
    present = dict.fromkeys(node.identity for node in nodes if node.identity is not None)
    return find_port_changes(draft.cameras, tuple(present))
