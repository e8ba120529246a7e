"""Sources of cameras in a saved calibration: passwords lie in a file of their own, for us alone.

A calibration is shown, sent to others and asked about; the address of a network camera stands in it
with `***`, and is completed when it is read.
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
# The addresses of network cameras with their passwords, kept by `mocapd calibrate` for the
# calibrations beside this file. Nobody else may read it, and nobody else needs it.

"""

Known = Mapping[tuple[str, str], str]  # id and address as it is shown: the true address


class _Camera(msgspec.Struct, frozen=True):
    id: Text
    source: Text


class _File(msgspec.Struct, frozen=True):
    """schema: what does not say it is of the first."""

    schema: int = SCHEMA
    camera: tuple[_Camera, ...] = ()


def known_sources(folder: Path) -> Known:
    """What is kept beside the calibrations of a folder. Raises InputError or ConfigError."""
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
    return sources_by_shown((one.id, one.source) for one in file.camera)


def passwords_of(saved: SavedCalibration) -> Known:
    """The sources with a password in them."""
    return sources_by_shown(
        (one.id, one.source) for one in saved.camera if has_password(one.source)
    )


def keep_sources(folder: Path, known: Known, named_in: str) -> None:
    """Write those of `known` that the calibrations of the folder name; `named_in`: their texts.

    Raises OSError.
    """
    path = folder / SECRETS
    kept = [
        {"id": name, "source": source}
        for (name, shown), source in known.items()
        if _quoted(shown) in named_in
    ]
    if not kept:
        path.unlink(missing_ok=True)
        return
    with whole_file(path, private=True) as partial:
        partial.write_text(
            _HEADER + tomli_w.dumps({"schema": SCHEMA, "camera": kept}), encoding="utf-8"
        )


def shown_sources(saved: SavedCalibration) -> SavedCalibration:
    """The same without passwords."""
    return _with_sources(saved, [without_password(one.source) for one in saved.camera])


def complete_sources(saved: SavedCalibration, folder: Path) -> SavedCalibration:
    """The same with the passwords that are kept in its folder; what is not stays as it is shown. Raises as
    `known_sources`."""
    if not any(is_masked(one.source) for one in saved.camera):
        return saved
    known = known_sources(folder)
    return _with_sources(
        saved, [known.get((one.id, one.source), one.source) for one in saved.camera]
    )


def require_password(camera: str, source: str, place: str) -> str:
    """A source that can be opened. Raises ConfigError where its password is not kept; `place`: where
    it should be."""
    if is_masked(source):
        raise ConfigError(
            f"the password of camera {camera!r} is not kept with the calibration ({source})",
            place,
            f"write its whole address, as [[camera]] with id and source, into {SECRETS} there, or"
            " into the configuration",
        )
    return source


def sources_by_shown(sources: Iterable[tuple[str, str]]) -> dict[tuple[str, str], str]:
    """Of pairs of an id and a true source, those sources by id and what is shown of them."""
    return {(name, without_password(source)): source for name, source in sources}


def _quoted(text: str) -> str:
    """As it stands between the quotes of a file of ours."""
    return tomli_w.dumps({"v": text})[len('v = "') : -len('"\n')]


def _with_sources(saved: SavedCalibration, sources: Iterable[str]) -> SavedCalibration:
    cameras = tuple(
        msgspec.structs.replace(one, source=source)
        for one, source in zip(saved.camera, sources, strict=True)
    )
    return msgspec.structs.replace(saved, camera=cameras)
