"""Which saved calibration a configuration runs on, and the cameras that it names."""

import logging
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from mocapd.boundary.files import is_absent, is_folder
from mocapd.boundary.urls import without_password
from mocapd.calibration.calibration_file import FILE_NAME, calibration_path, read_calibration
from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.calibration.from_saved import from_saved
from mocapd.calibration.saved_calibration import SavedCalibration, SavedCamera
from mocapd.calibration.saved_sources import require_password
from mocapd.capture.file import size_error
from mocapd.capture.kinds.source_kinds import identity_of, origin_of
from mocapd.capture.origin import Origin
from mocapd.config.sections import CameraSection, Config, ControlsSection
from mocapd.errors import ConfigError

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class LoadedCalibration:
    """A calibration as its file has it, and as a tracker takes it."""

    path: Path
    tables: SavedCalibration
    known: Calibration


def configured_calibration(config: Config) -> LoadedCalibration | None:
    """The calibration that `rig` names; else that of the state directory, for its own cameras.

    None for a rig in the capture format, for cameras that bring a rig with them, and for others than
    those that were calibrated. Raises InputError or ConfigError.
    """
    if config.rig is not None:
        return load_saved(config.rig) if is_calibration(config.rig) else None
    place = config.state_dir / FILE_NAME
    if any(origin_of(camera.source) for camera in config.camera) or is_absent(place):
        return None
    saved = load_saved(place)
    if config.camera and not fits(config.camera, saved.tables):
        _log.warning(
            "%s is of other cameras than those configured (%s), and not used",
            *(place, ", ".join(map(_named, saved.tables.camera))),
        )
        return None
    return saved


def is_calibration(path: Path) -> bool:
    """Whether it is a saved calibration, or a folder for one, and not a rig in the capture format."""
    return is_folder(path) or path.suffix == ".toml"


def load_saved(place: Path) -> LoadedCalibration:
    """The calibration of a file or folder, with its pictures. Raises InputError or ConfigError."""
    path = calibration_path(place)
    tables = read_calibration(path)
    return LoadedCalibration(path, tables, from_saved(tables, path))


def fits(cameras: Sequence[CameraSection], tables: SavedCalibration) -> bool:
    """Whether each of these is one of the calibrated cameras by id and source; a webcam may have been
    moved to another USB port since."""
    calibrated = {one.id: _model(one.source) for one in tables.camera}
    return all(calibrated.get(one.id) == _model(one.source) for one in cameras)


def _model(source: str) -> object:
    """A password may be written in one place and hidden in the other."""
    identity = identity_of(source)
    return identity.model if identity is not None else without_password(source)


def _named(camera: SavedCamera) -> str:
    return f"{camera.id} = {without_password(camera.source)}"


def cameras_of_calibration(saved: LoadedCalibration) -> tuple[CameraSection, ...]:
    """The calibrated cameras as a configuration has them. Raises ConfigError where a password is
    missing."""
    place = str(saved.path.parent)
    return tuple(
        CameraSection(
            one.id,
            require_password(one.id, one.source, place),
            one.fps_hz,
            controls=ControlsSection(**asdict(one.controls)),
        )
        for one in saved.tables.camera
    )


def known_of_recording(saved: LoadedCalibration, origin: Origin) -> Calibration:
    """What the calibration knows of a capture that its cameras recorded; the capture tells the stature
    where it does not. Raises ConfigError when they did not."""
    sizes = {camera.id: camera.size_px for camera in saved.tables.camera}
    for camera in origin.rig.cameras:
        if camera.name not in sizes:
            raise ConfigError(
                f"the calibration has no camera {camera.name!r}",
                str(saved.path),
                f"it has {', '.join(sizes)}: name the capture's cameras so, or calibrate them",
            )
        if sizes[camera.name] != camera.size_px:
            raise size_error(origin.rig_source, camera.name, camera.size_px, sizes[camera.name])
    return Calibration(wearer=Wearer(origin.stature_m)).overlaid(saved.known)
