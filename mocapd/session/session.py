"""A session of the daemon: cameras, rig and tracker, from the configuration.

The saved calibration gives cameras, rig, wearer and colours. So does a capture folder or simulated scenario that all
cameras share. Values of the configuration take precedence.
"""

import logging
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime
from functools import partial
from pathlib import Path

from mocapd.body.shape import BodyShape
from mocapd.calibration.calibration_file import LoadedCalibration, find_calibration
from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.calibration.from_origin import from_origin
from mocapd.calibration.saved_calibration import SavedCamera
from mocapd.calibration.saved_sources import require_password
from mocapd.capture.kinds.source_kinds import cameras_of_origin, common_origin, open_origin
from mocapd.capture.origin import camera_address
from mocapd.config.sections import CameraSection, Config, ControlsSection
from mocapd.errors import ConfigError
from mocapd.geometry.nominal_rig import DISTANCE_M, FIELD_OF_VIEW_DEG, HEIGHT_M, nominal_rig
from mocapd.geometry.rig_file import load_rig
from mocapd.session.camera_inputs import (
    CameraInput,
    camera_inputs,
    in_rig_order,
    picture_size,
    reductions,
)
from mocapd.session.tracker_setup import Progress, cache_resources, ready_tracker
from mocapd.shirt.colour.model_pictures import read_model, stroked_folder, stroked_image
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.trackers.registry import entry, require_calibration
from mocapd.tracking.base import Tracker
from mocapd.types import Rig
from mocapd.user_command import user_command

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """rig_source: file or scenario of the rig, for users; shape: the wearer's, for the first step; calibration: the
    tracker's; calibrated: time of a saved calibration (UTC)."""

    cameras: tuple[CameraInput, ...]
    rig: Rig | None
    rig_source: str
    tracker: Tracker
    shape: BodyShape
    calibration: Calibration = field(default_factory=Calibration)
    calibrated: datetime | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SessionPlan:
    """The resolved configuration, before any device is opened. cameras: configured, else calibrated; origin: of all
    cameras, may be empty; calibration: of configuration and calibration file; rig_source, calibrated: see Session."""

    config: Config
    cameras: tuple[CameraSection, ...]
    origin: str
    calibration: Calibration
    rig_source: str
    calibrated: datetime | None

    @property
    def assumes_rig(self) -> bool:
        """True for a single camera without a calibration, whose pose is assumed."""
        return (
            self.calibration.rig is None
            and not self.origin
            and len(self.cameras) == 1
            and entry(self.config.tracker.name).sees
        )


def open_session(config: Config, progress: Progress) -> Session:
    """Checks and prepares everything; `progress` reports long first-time work. Raises ConfigError, InputError or
    CannotCreateError."""
    plan = plan_session(config)
    return open_planned(plan, progress)


def plan_session(config: Config) -> SessionPlan:
    """Runs the fast checks. Raises ConfigError or InputError."""
    saved = find_calibration(config.rig, config.state_dir, config.sources)
    cameras = session_cameras(config.camera, saved, config.state_dir)
    origin = common_origin(camera.source for camera in cameras)
    calibration, rig_source, calibrated = Calibration(), "", None
    if saved is not None:
        calibration, rig_source = saved.calibration, str(saved.path)
        calibrated = saved.tables.made.when
    elif config.rig is not None:
        calibration, rig_source = Calibration(load_rig(config.rig)), str(config.rig)
    cameras = in_rig_order(cameras, calibration.rig)
    shirt = _configured_shirt(config.shirt.colour_model, cameras)
    calibration = calibration.overlaid(Calibration(shirt=shirt))
    plan = SessionPlan(config, cameras, origin, calibration, rig_source, calibrated)
    if not origin and not plan.assumes_rig:
        require_calibration(config.tracker.name, calibration)
    return plan


def open_planned(plan: SessionPlan, progress: Progress, is_beginning: bool = False) -> Session:
    """The second part of `open_session`; is_beginning: the parts of film and caches that are ready soonest suffice."""
    cache_dir, tracker = plan.config.cache_dir, plan.config.tracker
    calibration, rig_source = plan.calibration, plan.rig_source
    if plan.assumes_rig:
        calibration = replace(calibration, rig=_assumed_rig(plan.cameras[0]), assumes_rig=True)
        rig_source = "assumed"
    origin = open_origin(plan.origin, cache_dir, progress, is_beginning) if plan.origin else None
    if origin is not None and plan.calibrated is None:
        calibration = from_origin(origin).overlaid(calibration)
        rig_source = rig_source or origin.rig_source
    reduced_by = reductions(tracker.name, calibration.rig)
    inputs = camera_inputs(plan.cameras, calibration.rig, origin, reduced_by=reduced_by)
    resources = replace(
        cache_resources(cache_dir, progress, tracker.tracking), is_beginning=is_beginning
    )
    rehearsal = partial(progress, "preparing the tracker")
    assumed = calibration.assuming(tracker.stature_m)
    ready = ready_tracker(tracker.name, assumed, resources, rehearsal)
    return Session(
        inputs,
        calibration.rig,
        rig_source,
        ready.tracker,
        ready.shape,
        calibration,
        plan.calibrated,
    )


def cameras_of(capture: str) -> tuple[CameraSection, ...]:
    """Every camera of a capture folder or of `sim:SCENARIO`. Raises InputError or ConfigError."""
    return tuple(
        CameraSection(name, camera_address(capture, name)) for name in cameras_of_origin(capture)
    )


def session_cameras(
    configured: tuple[CameraSection, ...], saved: LoadedCalibration | None, state_dir: Path
) -> tuple[CameraSection, ...]:
    """The configured cameras, else the calibrated ones. The rate and controls that the configuration leaves open are
    those of the setup: a lens holds for one focus, colours for one exposure. Raises ConfigError where there are none,
    or a password is missing."""
    if configured:
        calibrated = {} if saved is None else {one.id: one for one in saved.tables.camera}
        return tuple(
            _as_calibrated(one, calibrated[one.id]) if one.id in calibrated else one
            for one in configured
        )
    if saved is None:
        raise ConfigError(
            "no camera is configured, and no calibration is saved",
            str(state_dir),
            f"set them up with `{user_command('calibrate')}`; or add [[camera]] (see `mocapd cameras`), or "
            "--camera ID=SOURCE",
        )
    place = str(saved.path.parent)
    return tuple(
        CameraSection(
            camera.id,
            require_password(camera.id, camera.source, place),
            camera.fps_hz,
            controls=ControlsSection(**asdict(camera.controls)),
        )
        for camera in saved.tables.camera
    )


def _as_calibrated(camera: CameraSection, saved: SavedCamera) -> CameraSection:
    """The camera with the rate and the controls of the calibration where the configuration leaves them open."""
    given = {name: value for name, value in asdict(camera.controls).items() if value is not None}
    return replace(
        camera,
        fps_hz=saved.fps_hz if camera.fps_hz is None else camera.fps_hz,
        controls=ControlsSection(**asdict(saved.controls) | given),
    )


def _configured_shirt(model: Path | None, cameras: Iterable[CameraSection]) -> ShirtColours:
    """The configured pictures of the shirt. Raises InputError or ConfigError."""
    return ShirtColours(
        read_model(stroked_folder(model)) if model else (),
        {
            camera.id: read_labelled(stroked_image(camera.white_balance))
            for camera in cameras
            if camera.white_balance
        },
    )


def _assumed_rig(camera: CameraSection) -> Rig:
    """A plausible rig of one camera without calibration; logs a warning."""
    _log.warning(
        "camera %r is not calibrated: assumed are a field of view of %.0f degrees and a place %.1f m"
        " high and %.1f m before the person, so distances and sizes will be off -- give a rig file"
        " (rig = ..., or --rig)",
        *(camera.id, FIELD_OF_VIEW_DEG, HEIGHT_M, DISTANCE_M),
    )
    return nominal_rig(camera.id, picture_size(camera))
