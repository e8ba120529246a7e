"""`calibration.toml`, read and checked value by value, and written whole or not at all."""

import hashlib
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import msgspec

from mocapd.calibrate.saved_calibration import SCHEMA, ColourFit, SavedCalibration
from mocapd.calibrate.toml_text import toml_text
from mocapd.errors import CannotCreateError, ConfigError, InputError
from mocapd.types import Bytes
from mocapd.whole_file import whole_file

FILE_NAME = "calibration.toml"
COLOURS = "colours"

_RECALIBRATE = "calibrate again (`mocapd calibrate`), or restore the file"
_HEADER = """\
# The calibration of mocapd's cameras, made by `mocapd calibrate`, read by `mocapd run`.
# Lengths are in metres, pixels where a name ends in _px; y points up from the floor. The pictures
# that the colours were read from lie in the folder colours/ beside this file, and show the wearer.
# The one before is kept beside it under the same name with .previous: rename it to go back.

"""
_PICTURE = re.compile(r".+-[0-9a-f]{12}(_strokes)?\.png")


def calibration_path(place: Path) -> Path:
    """The file of a state directory, or the file itself."""
    return place / FILE_NAME if place.is_dir() else place


def read_calibration(place: Path) -> SavedCalibration:
    """The calibration in a file, or in a folder by its usual name.

    Raises InputError when there is none, ConfigError naming file and key when it is damaged.
    """
    path = calibration_path(place)
    where = str(path)
    data = _toml(path)
    schema = data.get("schema")
    if schema != SCHEMA:
        told = "has no 'schema'" if schema is None else f"has schema {schema!r}"
        raise ConfigError(
            f"{told}, this mocapd reads schema {SCHEMA}",
            where,
            "use the mocapd that wrote it, or calibrate again (`mocapd calibrate`)",
        )
    for key, value in _floats(data, ""):
        if not math.isfinite(value):
            raise ConfigError(f"{key!r} is not finite", where, _RECALIBRATE)
    try:
        saved = msgspec.convert(data, SavedCalibration)
    except msgspec.ValidationError as error:
        what, _, key = str(error).partition(" - at ")
        named = key.strip("`").removeprefix("$").removeprefix(".")
        what = what[0].lower() + what[1:]
        raise ConfigError(f"{named}: {what}" if named else what, where, _RECALIBRATE) from None
    except ConfigError as error:  # the board's own check
        raise ConfigError(error.what, f"{where}, {error.where}", error.fix) from None
    ids = [camera.id for camera in saved.camera]
    if len(set(ids)) != len(ids):
        raise ConfigError("two cameras have one id", where, "rename one of them")
    saved.rig(where)
    return saved


def write_calibration(
    path: Path, saved: SavedCalibration, pictures: Mapping[str, tuple[Bytes, Bytes]]
) -> None:
    """Write the file, and make its folder if need be; the one before is kept as NAME.previous.toml.

    pictures: by camera id the picture (h,w,3) BGR and the strokes (h,w) that its `colour` is from.
    The file comes last, so what was there stays in force until all is written.
    Raises CannotCreateError.
    """
    folder = path.parent
    try:
        (folder / COLOURS).mkdir(parents=True, exist_ok=True)
        cameras = []
        for camera in saved.camera:
            colour = camera.colour
            if colour is not None:
                colour = _with_files(folder, camera.id, *pictures[camera.id], colour)
            cameras.append(msgspec.structs.replace(camera, colour=colour))
        text = _text(msgspec.structs.replace(saved, camera=tuple(cameras)))
        if path.exists():
            with whole_file(path.with_name(f"{path.stem}.previous{path.suffix}")) as partial:
                partial.write_bytes(path.read_bytes())
        with whole_file(path) as partial:
            partial.write_text(text, encoding="utf-8")
        _tidy(folder)
    except OSError as error:
        raise _cannot_write(error, path) from None


def rewrite_sources(path: Path, sources: Mapping[str, str]) -> None:
    """Give cameras of the saved calibration, by id, another source: they were plugged in elsewhere.

    Raises InputError, ConfigError or CannotCreateError; the file stays as it was then.
    """
    saved = read_calibration(path)
    cameras = tuple(
        msgspec.structs.replace(one, source=sources.get(one.id, one.source)) for one in saved.camera
    )
    try:
        with whole_file(path) as partial:
            partial.write_text(_text(msgspec.structs.replace(saved, camera=cameras)), "utf-8")
    except OSError as error:
        raise _cannot_write(error, path) from None


def _cannot_write(error: OSError, path: Path) -> CannotCreateError:
    return CannotCreateError(
        f"the calibration cannot be written ({error.strerror})",
        str(error.filename or path),
        "make room or the folder writable, or set state_dir; what was saved before is untouched",
    )


def _text(saved: SavedCalibration) -> str:
    tables: dict[str, Any] = msgspec.to_builtins(saved, builtin_types=(datetime,))
    return _HEADER + toml_text(tables)


def _with_files(
    folder: Path, camera: str, pixels: Bytes, strokes: Bytes, colour: ColourFit
) -> ColourFit:
    """Pictures are named by their content: one that is there already is the same one."""
    picture, drawn = _png(pixels), _png(strokes)
    stem = re.sub(r"[^\w.-]", "_", camera)
    mark = hashlib.sha256(picture + drawn).hexdigest()[:12]
    names = f"{stem}-{mark}.png", f"{stem}-{mark}_strokes.png"
    for name, data in zip(names, (picture, drawn), strict=True):
        path = folder / COLOURS / name
        if not path.is_file() or path.read_bytes() != data:
            with whole_file(path) as partial:
                partial.write_bytes(data)
    return msgspec.structs.replace(
        colour, picture=f"{COLOURS}/{names[0]}", strokes=f"{COLOURS}/{names[1]}"
    )


def _png(pixels: Bytes) -> bytes:
    return bytes(cv2.imencode(".png", pixels)[1])


def _tidy(folder: Path) -> None:
    """Remove pictures of ours that no calibration here names any more."""
    named = "".join(path.read_text("utf-8", "replace") for path in folder.glob("*.toml"))
    for path in (folder / COLOURS).iterdir():
        if _PICTURE.fullmatch(path.name) and path.name not in named:
            path.unlink()


def _toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError("no such calibration", str(path), "make one: `mocapd calibrate`") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"the calibration cannot be read ({error})", str(path), "check the path and its rights"
        ) from None
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ConfigError(f"not valid TOML ({error})", str(path), _RECALIBRATE) from None


def _floats(value: Any, key: str) -> Iterator[tuple[str, float]]:
    """Every float of the file with its key."""
    if isinstance(value, dict):
        for name, item in value.items():
            yield from _floats(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _floats(item, f"{key}[{i}]")
    elif isinstance(value, float):
        yield key, value
