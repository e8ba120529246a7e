"""Sources of cameras in a saved calibration: passwords lie in a file of their own, readable by the user alone.

Users show a calibration and send it to others, so its addresses of network cameras have `***` as password. The reader
puts the password back.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path

import msgspec
import tomli_w

from mocapd.boundary.files import MissingError, read_text
from mocapd.boundary.numbers import brief
from mocapd.boundary.parsing import convert, parse_toml
from mocapd.boundary.urls import has_password, is_masked, without_password
from mocapd.calibration.saved_calibration import SavedCalibration, Text
from mocapd.errors import ConfigError, MalformedError, NewerFileError
from mocapd.whole_file import whole_file

SECRETS = "cameras.secret.toml"
SCHEMA = 1

_MOST_BYTES = 256_000
_HEADER = """\
# The addresses of network cameras with their passwords, written by `mocapd calibrate` for the
# calibrations in this folder. Only their user can read this file; no other program needs it.

"""

MaskedToTrue = Mapping[tuple[str, str], str]  # camera id and masked address: the true address


class _Camera(msgspec.Struct, frozen=True):
    id: Text
    source: Text


class _File(msgspec.Struct, frozen=True):
    """schema: a file without it has schema 1."""

    schema: int = SCHEMA
    camera: tuple[_Camera, ...] = ()


def stored_sources(folder: Path) -> MaskedToTrue:
    """The addresses with passwords in the secrets file of a folder. Raises InputError or ConfigError."""
    path = folder / SECRETS
    try:
        text = read_text(path, _MOST_BYTES)
    except MissingError:
        return {}
    try:
        file: _File = convert(parse_toml(text), _File)
    except MalformedError as error:
        raise ConfigError(
            error.what, str(path), 'write [[camera]] with id = "..." and source = "..."'
        ) from None
    if file.schema > SCHEMA:
        raise NewerFileError(
            f"has schema {brief(file.schema)}, this mocapd reads {SCHEMA}",
            str(path),
            "use the mocapd that wrote it, or move it away and set the cameras up again",
        )
    return sources_by_masked((camera.id, camera.source) for camera in file.camera)


def passwords_of(saved: SavedCalibration) -> MaskedToTrue:
    """The sources with a password in them."""
    return sources_by_masked(
        (camera.id, camera.source) for camera in saved.camera if has_password(camera.source)
    )


def store_sources(folder: Path, addresses: MaskedToTrue, calibrations: str) -> None:
    """Write those addresses that appear in `calibrations`, the text of the folder's calibrations.

    Raises OSError.
    """
    path = folder / SECRETS
    entries = [
        {"id": name, "source": source}
        for (name, masked), source in addresses.items()
        if _toml_escape(masked) in calibrations
    ]
    if not entries:
        path.unlink(missing_ok=True)
        return
    with whole_file(path, private=True) as partial:
        partial.write_text(
            _HEADER + tomli_w.dumps({"schema": SCHEMA, "camera": entries}), encoding="utf-8"
        )


def masked_sources(saved: SavedCalibration) -> SavedCalibration:
    """The same without passwords."""
    return with_sources(saved, [without_password(camera.source) for camera in saved.camera])


def complete_sources(saved: SavedCalibration, folder: Path) -> SavedCalibration:
    """The same with passwords from the folder's secrets file; an address without an entry stays masked. Raises as
    `stored_sources`."""
    if not any(is_masked(camera.source) for camera in saved.camera):
        return saved
    addresses = stored_sources(folder)
    return with_sources(
        saved, [addresses.get((camera.id, camera.source), camera.source) for camera in saved.camera]
    )


def require_password(camera: str, source: str, place: str) -> str:
    """The source, if it can be opened. Raises ConfigError where the password is missing; `place`: the folder of the
    secrets file."""
    if is_masked(source):
        raise ConfigError(
            f"the password of camera {camera!r} is not stored with the calibration ({source})",
            place,
            f"write its whole address, as [[camera]] with id and source, into {SECRETS} there, or"
            " into the configuration",
        )
    return source


def sources_by_masked(sources: Iterable[tuple[str, str]]) -> dict[tuple[str, str], str]:
    """Pairs of camera id and true address, as a mapping from id and masked address to the true address."""
    return {(name, without_password(source)): source for name, source in sources}


def _toml_escape(text: str) -> str:
    """The text as TOML escapes it between quotes."""
    return tomli_w.dumps({"v": text})[len('v = "') : -len('"\n')]


def with_sources(saved: SavedCalibration, sources: Iterable[str]) -> SavedCalibration:
    """The same with these sources, in the order of its cameras."""
    cameras = tuple(
        msgspec.structs.replace(camera, source=source)
        for camera, source in zip(saved.camera, sources, strict=True)
    )
    return msgspec.structs.replace(saved, camera=cameras)
