"""What one run of the daemon works on: cameras, rig and tracker, from the configuration.

The saved calibration gives cameras, rig, wearer and colours. So do cameras that are all of one capture
folder, or all of one simulated scenario. What the configuration gives itself wins.
"""

import logging
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import partial

from mocapd.body.shape import BodyShape
from mocapd.calibration.calibration_record import Calibration
from mocapd.calibration.from_origin import from_origin
from mocapd.capture.kinds.source_kinds import (
    cameras_of_origin,
    open_origin,
)
from mocapd.capture.origin import camera_address
from mocapd.config.sections import CameraSection, Config
from mocapd.errors import ConfigError
from mocapd.geometry.nominal_rig import DISTANCE_M, FIELD_OF_VIEW_DEG, HEIGHT_M, nominal_rig
from mocapd.geometry.rig_file import load_rig
from mocapd.session.camera_inputs import (
    CameraInput,
    camera_inputs,
    common_origin,
    in_rig_order,
    picture_size,
)
from mocapd.session.from_configuration import from_configuration
from mocapd.session.saved_session import (
    LoadedCalibration,
    cameras_of_calibration,
    configured_calibration,
)
from mocapd.session.tracker_setup import Progress, ReadyTracker, cached, ready_tracker
from mocapd.trackers.base import Tracker
from mocapd.trackers.registry import entry, require_known
from mocapd.types import Rig

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """rig_source: the file or scenario that the rig is from, for people; shape: the wearer's, for the tracker's
    first step; known: what the tracker was built with; calibrated: when, where a saved calibration says so (UTC)."""

    cameras: tuple[CameraInput, ...]
    rig: Rig | None
    rig_source: str
    tracker: Tracker
    shape: BodyShape
    known: Calibration = field(default_factory=Calibration)
    calibrated: datetime | None = None


def cameras_of(capture: str) -> tuple[CameraSection, ...]:
    """Every camera of a capture folder or of `sim:SCENARIO`. Raises InputError or ConfigError."""
    return tuple(
        CameraSection(name, camera_address(capture, name)) for name in cameras_of_origin(capture)
    )


@dataclass(frozen=True, slots=True, eq=False)
class SessionPlan:
    """What a configuration comes to before anything is opened or made. config: with the cameras that are meant;
    origin: of all of them, empty when there is none; rig, rig_source: where given; saved: the calibration, if any;
    known: from both."""

    config: Config
    origin: str
    rig: Rig | None
    rig_source: str
    saved: LoadedCalibration | None
    known: Calibration

    @property
    def assumes_rig(self) -> bool:
        """Whether there is one camera, and nobody says where."""
        return (
            self.rig is None
            and not self.origin
            and len(self.config.camera) == 1
            and entry(self.config.tracker.name).sees
        )


def plan_session(config: Config) -> SessionPlan:
    """Check what can be checked at once. Raises ConfigError or InputError."""
    saved = configured_calibration(config)
    cameras = config.camera or (cameras_of_calibration(saved) if saved else ())
    if not cameras:
        raise ConfigError(
            "no camera is configured, and no calibration is saved",
            str(config.state_dir),
            "set them up with `mocapd calibrate`; or add [[camera]] (see `mocapd cameras`), or "
            "--camera ID=SOURCE",
        )
    config = replace(config, camera=cameras)
    origin = common_origin(cameras)
    rig, rig_source = _given_rig(config, saved)
    in_rig_order(cameras, rig)
    plan = SessionPlan(config, origin, rig, rig_source, saved, _known(config, rig, saved))
    if not origin and not plan.assumes_rig:
        require_known(config.tracker.name, plan.known)
    return plan


def open_session(config: Config, progress: Progress) -> Session:
    """Check and prepare everything; `progress` is told while something long is made for the first
    time. Raises ConfigError, InputError or CannotCreateError."""
    return open_planned(plan_session(config), progress)


def open_planned(plan: SessionPlan, progress: Progress) -> Session:
    """The rest of `open_session`."""
    config, cameras, origin, saved = plan.config, plan.config.camera, plan.origin, plan.saved
    rig, rig_source, known = plan.rig, plan.rig_source, plan.known
    if plan.assumes_rig:
        rig, rig_source = _assumed_rig(cameras[0]), "assumed"
        known = replace(known, rig=rig)
    opened = open_origin(origin, config.cache_dir, progress) if origin else None
    if opened is not None and saved is None:
        known = from_origin(opened).overlaid(known)
        rig, rig_source = (rig, rig_source) if rig else (opened.rig, opened.rig_source)
    inputs = camera_inputs(cameras, rig, opened)
    ready = _ready_tracker(config, known, progress)
    made = saved.tables.made.when if saved is not None else None
    return Session(inputs, rig, rig_source, ready.tracker, ready.shape, known, made)


def _given_rig(config: Config, saved: LoadedCalibration | None) -> tuple[Rig | None, str]:
    """The rig of the calibration or the rig file, and which file that is."""
    if saved is not None:
        return saved.known.rig, str(saved.path)
    return (load_rig(config.rig), str(config.rig)) if config.rig else (None, "")


def _known(config: Config, rig: Rig | None, saved: LoadedCalibration | None) -> Calibration:
    """From configuration and calibration: what the configuration itself gives goes before."""
    own = from_configuration(config.shirt, config.camera, rig)
    return own if saved is None else saved.known.overlaid(own)


def _assumed_rig(camera: CameraSection) -> Rig:
    """Where one camera without calibration probably is; says so."""
    _log.warning(
        "camera %r is not calibrated: assumed are a field of view of %.0f degrees and a place %.1f m"
        " high and %.1f m before the person, so distances and sizes will be off -- give a rig file"
        " (rig = ..., or --rig)",
        *(camera.id, FIELD_OF_VIEW_DEG, HEIGHT_M, DISTANCE_M),
    )
    return nominal_rig(camera.id, picture_size(camera))


def _ready_tracker(config: Config, known: Calibration, progress: Progress) -> ReadyTracker:
    """Built, and its kernels warm."""
    own = config.tracker
    return ready_tracker(
        own.name,
        known.assuming(own.stature_m),
        cached(config.cache_dir, progress, own.tracking),
        partial(progress, "preparing the tracker"),
    )
