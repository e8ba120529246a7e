"""Writes `calibration.toml` atomically, with its pictures and passwords in the same folder."""

import hashlib
import logging
import re
from collections.abc import Mapping
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import msgspec

from mocapd.boundary.files import is_absent, is_file, read_file
from mocapd.boundary.folders import private_folder
from mocapd.calibration.calibration_file import MOST_SETUP_BYTES, read_calibration, read_tables
from mocapd.calibration.saved_calibration import ColourFit, SavedCalibration
from mocapd.calibration.saved_sources import (
    SECRETS,
    masked_sources,
    passwords_of,
    store_sources,
    stored_sources,
    with_sources,
)
from mocapd.calibration.toml_text import toml_text
from mocapd.errors import CannotCreateError, InputError, MocapdError, NewerFileError
from mocapd.output_file import FileKind
from mocapd.quarantine import quarantine
from mocapd.types import Bytes, LabelledPicture
from mocapd.whole_file import tidy, whole_file

COLOURS = "colours"

_HEADER = """\
# The calibration of mocapd's cameras, made by `mocapd calibrate`, read by `mocapd run`.
# Lengths are in metres, pixels where a name ends in _px; y points up from the floor. The pictures
# that the colours were read from lie in the folder colours/ beside this file, and show the wearer.
# The previous calibration lies in the same folder, with .previous in its name: rename it to go back.

"""
CALIBRATION_KIND = FileKind(
    "a calibration", lambda head: re.search(rb"(?m)^schema = \d+$", head) is not None
)
_log = logging.getLogger(__name__)
_PICTURE = re.compile(r".+-[0-9a-f]{12}(_strokes)?\.png")


def write_calibration(
    path: Path,
    saved: SavedCalibration,
    pictures: Mapping[str, LabelledPicture],
    own_folder: bool = True,
) -> None:
    """Write the file, and create its folder if needed. An earlier file becomes NAME.previous.toml, or goes into
    quarantine where this mocapd cannot read it.

    pictures: by camera id the picture with strokes that gave the camera's `colour`.
    Only the user may read the files. own_folder: the folder's permissions are restricted, too.
    The file comes last, so the earlier one stays in force until all is written.
    Raises CannotCreateError, or ConfigError where stored passwords cannot be read.
    """
    folder = path.parent
    addresses = {**stored_sources(folder), **passwords_of(saved)}
    try:
        if own_folder:
            private_folder(folder)
        text = _text(_with_pictures(folder, saved, pictures))
        if not is_absent(path):
            addresses = {**_keep_before(path), **addresses}
        _write(path, text, addresses)
        _tidy(path)
    except OSError as error:
        raise _cannot_write(error, path) from None


def write_setup(
    path: Path, saved: SavedCalibration, pictures: Mapping[str, LabelledPicture]
) -> None:
    """Write a setup in progress in the same way, without passwords and without a .previous file. Raises CannotCreateError."""
    try:
        private_folder(path.parent)
        text = _text(_with_pictures(path.parent, saved, pictures))
        if len(text) > MOST_SETUP_BYTES:
            raise CannotCreateError(
                f"would have {len(text)} bytes, at most {MOST_SETUP_BYTES} are allowed", str(path)
            )
        with whole_file(path, private=True) as partial:
            partial.write_text(text, encoding="utf-8")
        _tidy(path)
    except OSError as error:
        raise _cannot_write(error, path) from None


def remove_setup(path: Path) -> None:
    """Remove a setup in progress with its pictures, except pictures of files in quarantine. Raises OSError."""
    if not path.exists():
        return
    now_s = path.stat().st_mtime
    path.unlink()
    _tidy_folder(path.parent, now_s)


def rewrite_sources(path: Path, sources: Mapping[str, str]) -> None:
    """Change sources of cameras in the saved calibration, by id, after the user plugged them in elsewhere.

    Raises InputError, ConfigError or CannotCreateError; then the file is unchanged.
    """
    saved = read_calibration(path)
    saved = with_sources(saved, [sources.get(one.id, one.source) for one in saved.camera])
    addresses = {**stored_sources(path.parent), **passwords_of(saved)}
    try:
        _write(path, _text(saved), addresses)
    except OSError as error:
        raise _cannot_write(error, path) from None


def _write(path: Path, text: str, addresses: Mapping[tuple[str, str], str]) -> None:
    """The passwords first: without them the file would say too little."""
    store_sources(path.parent, addresses, text + _texts_of(path.parent))
    with whole_file(path, private=True) as partial:
        partial.write_text(text, encoding="utf-8")


def _keep_before(path: Path) -> dict[tuple[str, str], str]:
    """Rename the existing calibration to .previous, or put it into quarantine where it cannot be read.

    Returns the passwords that an earlier version wrote into it. Raises OSError.
    """
    try:
        saved = read_tables(path)
    except MocapdError as error:
        quarantined = quarantine(path, "newer" if isinstance(error, NewerFileError) else "corrupt")
        _log.warning("%s cannot be used (%s), and is now %s", path, error.what, quarantined.name)
        return {}
    passwords = dict(passwords_of(saved))
    before = _text(saved).encode() if passwords else path.read_bytes()
    previous = path.with_name(f"{path.stem}.previous{path.suffix}")
    with whole_file(previous, private=True) as partial:
        partial.write_bytes(before)
    return passwords


def _cannot_write(error: OSError, path: Path) -> CannotCreateError:
    return CannotCreateError(
        f"the calibration cannot be written ({error.strerror})",
        str(error.filename or path),
        "make room or the folder writable, or set state_dir; what was saved before is untouched",
    )


def _text(saved: SavedCalibration) -> str:
    tables: dict[str, Any] = msgspec.to_builtins(masked_sources(saved), builtin_types=(datetime,))
    return _HEADER + toml_text(tables)


def _with_pictures(
    folder: Path, saved: SavedCalibration, pictures: Mapping[str, LabelledPicture]
) -> SavedCalibration:
    """Write the pictures, and return the tables with their file names. Raises OSError."""
    private_folder(folder / COLOURS)
    cameras = []
    for camera in saved.camera:
        colour = camera.colour
        if colour is not None:
            colour = _with_files(folder, camera.id, pictures[camera.id], colour)
        cameras.append(msgspec.structs.replace(camera, colour=colour))
    return msgspec.structs.replace(saved, camera=tuple(cameras))


def _with_files(
    folder: Path, camera: str, labelled: LabelledPicture, colour: ColourFit
) -> ColourFit:
    """File names contain a hash of the content: an existing file of that name is identical."""
    picture, drawn = _png(labelled.pixels), _png(labelled.labels)
    stem = re.sub(r"[^\w.-]", "_", camera)
    mark = hashlib.sha256(picture + drawn).hexdigest()[:12]
    names = f"{stem}-{mark}.png", f"{stem}-{mark}_strokes.png"
    for name, data in zip(names, (picture, drawn), strict=True):
        path = folder / COLOURS / name
        if is_file(path) and path.read_bytes() == data:
            path.chmod(0o600)  # an earlier version let everybody read it
            continue
        with whole_file(path, private=True) as partial:
            partial.write_bytes(data)
    return msgspec.structs.replace(
        colour, picture=f"{COLOURS}/{names[0]}", strokes=f"{COLOURS}/{names[1]}"
    )


def _png(pixels: Bytes) -> bytes:
    return bytes(cv2.imencode(".png", pixels)[1])


def _texts_of(folder: Path) -> str:
    """All calibrations of a folder as text, those in quarantine included."""
    content = b""
    for path in folder.glob("*.toml*"):
        if path.name != SECRETS:
            with suppress(InputError):  # not a file of mocapd
                content += read_file(path, MOST_SETUP_BYTES)
    return content.decode("utf-8", "replace")


def _tidy(path: Path) -> None:
    """Remove partial files, and pictures of ours that no calibration in the folder names."""
    _tidy_folder(path.parent, path.stat().st_mtime)


def _tidy_folder(folder: Path, now_s: float) -> None:
    tidy(folder, now_s)
    tidy(folder / COLOURS, now_s)
    texts = _texts_of(folder)
    for picture in (folder / COLOURS).iterdir():
        if _PICTURE.fullmatch(picture.name) and picture.name not in texts:
            picture.unlink()
