"""What one run of the daemon works on: cameras, rig and tracker, from the configuration.

The saved calibration gives cameras, rig, wearer and colours. So do cameras that are all of one capture
folder, or all of one simulated scenario. What the configuration gives itself wins.
"""

import logging
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from mocapd.calibration.from_capture import from_capture
from mocapd.calibration.record import Calibration
from mocapd.capture.capture_folder import load_folder
from mocapd.capture.url import is_url
from mocapd.config.sections import CameraSection, Config
from mocapd.errors import ConfigError
from mocapd.geometry.nominal_rig import DISTANCE_M, FIELD_OF_VIEW_DEG, HEIGHT_M, nominal_rig
from mocapd.geometry.rig_file import load_rig
from mocapd.session.camera_inputs import CameraInput, camera_inputs, picture_size
from mocapd.session.from_configuration import from_configuration
from mocapd.session.saved_session import (
    LoadedCalibration,
    cameras_of_calibration,
    configured_calibration,
)
from mocapd.session.tracker_setup import Progress, cached, ready_tracker
from mocapd.trackers.base import Tracker
from mocapd.trackers.registry import entry
from mocapd.types import Rig

_log = logging.getLogger(__name__)

SIM = "sim:"  # the renderer is imported for such cameras only: it takes a second


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """`rig_source`: the file or scenario that the rig is from, for people."""

    cameras: tuple[CameraInput, ...]
    rig: Rig | None
    rig_source: str
    tracker: Tracker


def cameras_of(capture: str) -> tuple[CameraSection, ...]:
    """Every camera of a capture folder or of `sim:SCENARIO`. Raises InputError or ConfigError."""
    if capture.startswith(SIM):
        from mocapd.session import simulation

        names = simulation.camera_names(capture)
    else:
        names = load_rig(Path(capture) / "rig.json").names
    return tuple(CameraSection(name, f"{capture}#{name}") for name in names)


def open_session(config: Config, progress: Progress) -> Session:
    """Check and prepare everything; `progress` is told while something long is made for the first
    time. Raises ConfigError, InputError or CannotCreateError."""
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
    origin = _common_origin(cameras)
    if origin.startswith(SIM):
        return _simulated(config, origin, saved, progress)
    rig, rig_source = _given_rig(config, saved)
    if rig is None and not origin and len(cameras) == 1 and entry(config.tracker.name).sees:
        rig, rig_source = _assumed_rig(cameras[0]), "assumed"
    known = _known(config, rig, saved)
    if origin and saved is None:
        folder = load_folder(Path(origin))
        known = from_capture(folder).overlaid(known)
        rig, rig_source = (rig, rig_source) if rig else (folder.rig, str(folder.path / "rig.json"))
    return Session(
        camera_inputs(cameras, rig), rig, rig_source, _ready_tracker(config, known, progress)
    )


def _given_rig(config: Config, saved: LoadedCalibration | None) -> tuple[Rig | None, str]:
    """The rig of the calibration or the rig file, and which file that is."""
    if saved is not None:
        return saved.known.rig, str(saved.path)
    return (load_rig(config.rig), str(config.rig)) if config.rig else (None, "")


def _known(config: Config, rig: Rig | None, saved: LoadedCalibration | None) -> Calibration:
    """From configuration and calibration: what the configuration itself gives goes before."""
    own = from_configuration(config.tracker, config.camera, rig)
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


def _simulated(
    config: Config, source: str, saved: LoadedCalibration | None, progress: Progress
) -> Session:
    from mocapd.session import simulation

    film = simulation.open_film(source, config.cache_dir, progress)
    known, rig_source = _known(config, None, saved), source
    if saved is None:
        known = simulation.from_scenario(film.setup).overlaid(known)
    else:
        rig_source = str(saved.path)
    tracker = _ready_tracker(config, known, progress)
    # last, as they begin to play now
    cameras = simulation.simulated_inputs(config.camera, film)
    return Session(cameras, known.rig, rig_source, tracker)


def _ready_tracker(config: Config, known: Calibration, progress: Progress) -> Tracker:
    """Built, and its kernels warm."""
    own = config.tracker
    return ready_tracker(
        own.name,
        known.assuming(own.stature_m),
        cached(config.cache_dir, progress, own),
        own.variant,
        partial(progress, "preparing the tracker"),
    )


def _common_origin(cameras: tuple[CameraSection, ...]) -> str:
    """The one capture folder or scenario that all cameras are of; empty when there is none."""
    # a URL is no folder, also where its password or fragment has a `#`
    origins = {"" if is_url(one.source) else one.source.rpartition("#")[0] for one in cameras}
    simulated = any(camera.source.startswith(SIM) for camera in cameras)
    if simulated and (len(origins) > 1 or origins == {""}):
        raise ConfigError(
            "simulated cameras must all be of one scenario",
            "camera",
            "write source = sim:SCENARIO#CAMERA for each",
        )
    return origins.pop() if len(origins) == 1 else ""
