"""Finds, reads and checks a saved calibration, `calibration.toml`."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.boundary.files import MissingError, is_absent, is_folder, read_text
from mocapd.boundary.numbers import brief, check_numbers
from mocapd.boundary.parsing import convert, parse_toml
from mocapd.boundary.urls import without_password
from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.calibration.saved_calibration import SCHEMA, SavedCalibration
from mocapd.calibration.saved_sources import complete_sources
from mocapd.capture.file import size_error
from mocapd.capture.kinds.source_kinds import identity_of, origin_of
from mocapd.capture.origin import Origin
from mocapd.errors import ConfigError, InputError, MalformedError, NewerFileError
from mocapd.shirt.colour.model_pictures import personal_model
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.user_command import user_command

FILE_NAME = "calibration.toml"
MOST_SETUP_BYTES = 2_000_000  # a picture of the board takes 0.5 to 2 kB

_MOST_BYTES = 256_000  # a camera takes 1 kB
RECALIBRATE = f"calibrate again (`{user_command('calibrate')}`), or restore the file"
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class LoadedCalibration:
    """A calibration as the tables of its file, and as the record that a tracker takes."""

    path: Path
    tables: SavedCalibration
    calibration: Calibration


def find_calibration(
    rig: Path | None, state_dir: Path, sources: Mapping[str, str]
) -> LoadedCalibration | None:
    """The calibration at `rig`, or else the one in the state directory if it belongs to the configured cameras.
    sources: addresses of the configured cameras, by id.

    None for a rig in the capture format, for cameras that bring their own rig, and where other cameras
    were calibrated. Raises InputError or ConfigError.
    """
    if rig is not None:
        path = calibration_path(rig)
        return load_calibration(path) if path.suffix == ".toml" else None
    path = state_dir / FILE_NAME
    if any(map(origin_of, sources.values())) or is_absent(path):
        return None
    saved = load_calibration(path)
    if _fits(saved.tables, sources):
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
    """The record of these tables with their pictures; without a rig where the cameras have no extrinsics.
    `path`: the file of the tables. Raises InputError or ConfigError."""
    rig = tables.rig(str(path)) if tables.is_placed else None
    wearer = tables.wearer_record()
    colours = {camera.id: camera.colour for camera in tables.camera if camera.colour is not None}
    pictures = {
        name: read_labelled(path.parent / fit.picture, path.parent / fit.strokes)
        for name, fit in colours.items()
    }
    W = {name: np.array(fit.W) for name, fit in colours.items()}
    personal = tables.wearer is not None and tables.wearer.personal_colours
    shirt = ShirtColours(personal_model(pictures, W) if personal else (), pictures)
    return Calibration(rig, wearer, shirt)


def calibration_of_recording(saved: LoadedCalibration, origin: Origin) -> Calibration:
    """The calibration for a capture of the same cameras. The capture gives the stature where the calibration has none.
    Raises ConfigError when the cameras differ."""
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
    return Calibration(wearer=Wearer(origin.stature_m)).overlaid(saved.calibration)


def calibration_path(place: Path) -> Path:
    """The file of a state directory, or the file itself."""
    return place / FILE_NAME if is_folder(place) else place


def read_calibration(path: Path) -> SavedCalibration:
    """The calibration in a file, with the passwords of its sources as far as its folder stores them.

    Raises InputError for a missing file, ConfigError naming file and key for a damaged one.
    """
    try:
        saved = read_tables(path)
    except MissingError:
        raise InputError(
            "no such calibration", str(path), f"make one: `{user_command('calibrate')}`"
        ) from None
    if not saved.is_placed:
        raise ConfigError(
            "the setup is not finished: it does not say where the cameras are",
            str(path),
            f"finish it: `{user_command('calibrate')}`",
        )
    return complete_sources(saved, path.parent)


def read_tables(path: Path, most_bytes: int = _MOST_BYTES) -> SavedCalibration:
    """The tables exactly as in the file, sources without passwords; perhaps of a setup in progress.

    Raises MissingError for a missing file, InputError, or ConfigError naming file and key for a damaged one.
    """
    where = str(path)
    text = read_text(path, most_bytes)
    try:
        data = parse_toml(text)
    except MalformedError as error:
        raise ConfigError(f"not valid TOML ({error.what})", where, RECALIBRATE) from None
    schema = data.get("schema")
    if schema != SCHEMA:
        problem = "has no 'schema'" if schema is None else f"has schema {brief(schema)}"
        newer = isinstance(schema, int) and schema > SCHEMA
        raise (NewerFileError if newer else ConfigError)(
            f"{problem}, this mocapd reads schema {SCHEMA}",
            where,
            f"use the mocapd that wrote it, or calibrate again (`{user_command('calibrate')}`)",
        )
    try:
        check_numbers(data)
        saved: SavedCalibration = convert(data, SavedCalibration)
    except MalformedError as error:
        what, _, key = error.what.partition(" - at ")
        named = key.strip("`").removeprefix("$").removeprefix(".")
        what = what[0].lower() + what[1:]
        raise ConfigError(f"{named}: {what}" if named else what, where, RECALIBRATE) from None
    except ConfigError as error:  # the board's own check
        raise ConfigError(error.what, f"{where}, {error.where}", error.fix) from None
    ids = [camera.id for camera in saved.camera]
    if len(set(ids)) != len(ids):
        raise ConfigError("two cameras have one id", where, "rename one of them")
    if saved.is_placed:
        saved.rig(where)
    return saved


def _fits(tables: SavedCalibration, sources: Mapping[str, str]) -> bool:
    """Whether the calibration contains each of these cameras with its id and source."""
    calibrated = {camera.id: _model(camera.source) for camera in tables.camera}
    return all(calibrated.get(name) == _model(source) for name, source in sources.items())


def _model(source: str) -> object:
    """An identity of a camera that ignores the USB port of a webcam, and the password of an address."""
    identity = identity_of(source)
    return identity.model if identity is not None else without_password(source)
