"""A saved calibration, found and read: what its file says, and what a tracker takes from it."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.boundary.files import is_absent
from mocapd.boundary.urls import without_password
from mocapd.calibration.calibration_file import FILE_NAME, calibration_path, read_calibration
from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.calibration.saved_calibration import SavedCalibration
from mocapd.capture.file import size_error
from mocapd.capture.kinds.source_kinds import identity_of, origin_of
from mocapd.capture.origin import Origin
from mocapd.errors import ConfigError
from mocapd.shirt.colour.model_pictures import personal_model
from mocapd.shirt.colour.strokes import read_labelled

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class LoadedCalibration:
    """A calibration as its file has it, and as a tracker takes it."""

    path: Path
    tables: SavedCalibration
    known: Calibration


def find_calibration(
    rig: Path | None, state_dir: Path, sources: Mapping[str, str]
) -> LoadedCalibration | None:
    """The calibration that `rig` names; else that of the state directory, for its own cameras. sources: of the
    configured cameras, by id.

    None for a rig in the capture format, for cameras that bring a rig with them, and for others than
    those that were calibrated. Raises InputError or ConfigError.
    """
    path = calibration_path(rig) if rig is not None else state_dir / FILE_NAME
    if rig is not None and path.suffix != ".toml":
        return None
    if rig is None and (any(map(origin_of, sources.values())) or is_absent(path)):
        return None
    saved = load_calibration(path)
    if rig is not None or _fits(saved.tables, sources):
        return saved
    _log.warning(
        "%s is of other cameras than those configured (%s), and not used",
        *(path, ", ".join(f"{c.id} = {without_password(c.source)}" for c in saved.tables.camera)),
    )
    return None


def load_calibration(path: Path) -> LoadedCalibration:
    """The calibration in a file, with its pictures. Raises InputError or ConfigError."""
    tables = read_calibration(path)
    return LoadedCalibration(path, tables, from_saved(tables, path))


def from_saved(tables: SavedCalibration, path: Path) -> Calibration:
    """What the tables know, with the pictures that they name, and without a rig where the cameras are not placed;
    `path`: their file. Raises InputError or ConfigError."""
    rig = tables.rig(str(path)) if tables.is_placed else None
    colours = {one.id: one.colour for one in tables.camera if one.colour is not None}
    pictures = {
        name: read_labelled(path.parent / one.picture, path.parent / one.strokes)
        for name, one in colours.items()
    }
    W = {name: np.array(one.W) for name, one in colours.items()}
    personal = tables.wearer is not None and tables.wearer.personal_colours
    shirt = ShirtColours(personal_model(pictures, W) if personal else (), pictures)
    return Calibration(rig, tables.known_wearer(), shirt)


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


def _fits(tables: SavedCalibration, sources: Mapping[str, str]) -> bool:
    """Whether each of these cameras was calibrated, by id and source."""
    calibrated = {camera.id: _model(camera.source) for camera in tables.camera}
    return all(calibrated.get(name) == _model(source) for name, source in sources.items())


def _model(source: str) -> object:
    """What two addresses of one camera share: a webcam may be at another USB port, a password hidden in one of them."""
    identity = identity_of(source)
    return identity.model if identity is not None else without_password(source)
