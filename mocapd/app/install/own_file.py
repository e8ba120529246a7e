"""Our files in the system's folders: updated while unchanged by hand, else left alone."""

import grp
import hashlib
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path

from mocapd.boundary.files import MissingError, read_file
from mocapd.errors import (
    CannotCreateError,
    InputError,
    PermissionDeniedError,
    creation_errors,
)
from mocapd.whole_file import whole_file

MODE = 0o644
FOLDER_MODE = 0o755
SECRET_MODE = 0o640  # with the group of the service that reads it
NEW = ".new"  # suffix of our version of a file that was changed by hand

_MOST_BYTES = 1 << 20
_HEAD = (
    "# Made by `mocapd install-service`, which leaves a changed file alone. Better than a change:"
)
_FIRST_LINE = re.compile(rb"# Made by `mocapd install-service`[^\n]* \[([0-9a-f]{16})\]\n")


class Outcome(StrEnum):
    """The outcome for a file, or the expected outcome of a dry run."""

    MADE = "made"
    RENEWED = "renewed"
    UNCHANGED = "as it was"
    KEPT = "kept, as it was changed by hand"
    REMOVED = "removed"
    ABSENT = "was not there"


def with_marker(text: str, better: str) -> str:
    """Adds a first line with a checksum that reveals later changes. better: advice instead of changing the file."""
    return f"{_HEAD} {better} [{_digest(text.encode())}]\n{text}"


def put(path: Path, text: str, dry_run: bool) -> Outcome:
    """Writes a text with marker, except in a dry run. A file that was changed stays; ours gets the suffix NEW.

    Raises PermissionDeniedError or CannotCreateError.
    """
    data = text.encode()
    there = _read(path)
    if there == data:
        return Outcome.UNCHANGED
    if there is None or is_unchanged(there):
        if not dry_run:
            _write(path, data)
        return Outcome.MADE if there is None else Outcome.RENEWED
    if not dry_run:
        _write(path.with_name(path.name + NEW), data)
    return Outcome.KEPT


def put_once(path: Path, text: str, dry_run: bool, group: str) -> Outcome:
    """Writes a missing file, which then belongs to the admin. Raises as `put`.

    It may hold passwords: readable by owner and group only, root's group while `group` does not exist.
    """
    if _read(path) is not None:
        return Outcome.UNCHANGED
    if not dry_run:
        _write(path, text.encode(), SECRET_MODE, gid_of(group))
    return Outcome.MADE


def gid_of(group: str) -> int | None:
    """The group's id; None for a missing group."""
    try:
        return grp.getgrnam(group).gr_gid
    except KeyError:
        return None


def take_away(path: Path, dry_run: bool) -> Outcome:
    """Removes an unchanged file, and its version with the suffix NEW. Raises as `put`."""
    there = _read(path)
    newer = path.with_name(path.name + NEW)
    with _named_errors(path):
        if not dry_run:
            newer.unlink(missing_ok=True)
        if there is None:
            return Outcome.ABSENT
        if not is_unchanged(there):
            return Outcome.KEPT
        if not dry_run:
            path.unlink()
    return Outcome.REMOVED


def is_unchanged(data: bytes) -> bool:
    """True if the checksum of the marker fits: the file is as some version wrote it."""
    marker = _FIRST_LINE.match(data)
    return marker is not None and marker[1].decode() == _digest(data[marker.end() :])


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def _read(path: Path) -> bytes | None:
    """The content; None for a missing file. Raises CannotCreateError for anything but a regular file."""
    try:
        return read_file(path, _MOST_BYTES)
    except MissingError:
        return None
    except InputError as error:
        raise CannotCreateError(
            error.what, str(path), "look what it is, and move it away"
        ) from None


def _write(path: Path, data: bytes, mode: int = MODE, gid: int | None = None) -> None:
    with _named_errors(path):
        if not path.parent.is_dir():
            path.parent.mkdir(parents=True)
            path.parent.chmod(FOLDER_MODE)  # whatever the umask: the service has a user of its own
        with whole_file(path) as partial:
            partial.write_bytes(data)
            if gid is not None and os.geteuid() == 0:
                os.chown(partial, -1, gid)
            partial.chmod(mode)  # whatever the umask


@contextmanager
def _named_errors(path: Path) -> Iterator[None]:
    """Converts OSError to MocapdError."""
    with creation_errors(path, "make the folder writable", "cannot be changed"):
        try:
            yield
        except PermissionError as error:
            raise PermissionDeniedError(
                f"cannot be changed ({error.strerror})", str(path), "run it as root, or with --user"
            ) from None
