"""A file of ours in a folder of the system's: renewed while nobody has changed it, else left alone."""

import grp
import hashlib
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path

from mocapd.boundary.files import MissingError, read_file
from mocapd.errors import CannotCreateError, InputError, PermissionDeniedError, mend_of
from mocapd.whole_file import whole_file

MODE = 0o644
SECRET_MODE = 0o640  # with the group of the service that reads it
NEW = ".new"  # what would have been written, beside a file that was changed

_MOST_BYTES = 1 << 20
_HEAD = (
    "# Made by `mocapd install-service`, which leaves a changed file alone. Better than a change:"
)
_FIRST_LINE = re.compile(rb"# Made by `mocapd install-service`[^\n]* \[([0-9a-f]{16})\]\n")


class Outcome(StrEnum):
    """What became of a file, or would become of it."""

    MADE = "made"
    RENEWED = "renewed"
    UNCHANGED = "as it was"
    KEPT = "kept, as it was changed by hand"
    REMOVED = "removed"
    ABSENT = "was not there"


def marked(text: str, better: str) -> str:
    """With a first line by which a later change is seen. better: what to do instead of changing the file."""
    return f"{_HEAD} {better} [{_digest(text.encode())}]\n{text}"


def put(path: Path, text: str, dry_run: bool) -> Outcome:
    """Write a marked text, or only say what would be done. One that was changed stays, with ours beside it.

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
    """Write a text that is the admin's from then on, where there is none. Raises as `put`.

    It may come to hold passwords: besides its owner only the group may read it, root's while there is no such group.
    """
    if _read(path) is not None:
        return Outcome.UNCHANGED
    if not dry_run:
        _write(path, text.encode(), SECRET_MODE, gid_of(group))
    return Outcome.MADE


def gid_of(group: str) -> int | None:
    """None while there is no such group."""
    try:
        return grp.getgrnam(group).gr_gid
    except KeyError:
        return None


def take_away(path: Path, dry_run: bool) -> Outcome:
    """Remove what nobody has changed, and what was put beside it. Raises as `put`."""
    there = _read(path)
    beside = path.with_name(path.name + NEW)
    with _told(path):
        if not dry_run:
            beside.unlink(missing_ok=True)
        if there is None:
            return Outcome.ABSENT
        if not is_unchanged(there):
            return Outcome.KEPT
        if not dry_run:
            path.unlink()
    return Outcome.REMOVED


def is_unchanged(data: bytes) -> bool:
    """Whether this is what a version of ours has written."""
    found = _FIRST_LINE.match(data)
    return found is not None and found[1].decode() == _digest(data[found.end() :])


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def _read(path: Path) -> bytes | None:
    """None where there is none. Raises CannotCreateError for anything but a regular file."""
    try:
        return read_file(path, _MOST_BYTES)
    except MissingError:
        return None
    except InputError as error:
        raise CannotCreateError(
            error.what, str(path), "look what it is, and move it away"
        ) from None


def _write(path: Path, data: bytes, mode: int = MODE, gid: int | None = None) -> None:
    with _told(path):
        path.parent.mkdir(mode=0o755, parents=True, exist_ok=True)
        with whole_file(path) as partial:
            partial.write_bytes(data)
            if gid is not None and os.geteuid() == 0:
                os.chown(partial, -1, gid)
            partial.chmod(mode)  # whatever the umask


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """An OSError by its name."""
    try:
        yield
    except PermissionError as error:
        raise PermissionDeniedError(
            f"cannot be changed ({error.strerror})", str(path), "run it as root, or with --user"
        ) from None
    except OSError as error:
        raise CannotCreateError(
            f"cannot be changed ({error.strerror})",
            str(path),
            mend_of(error, "make the folder writable"),
        ) from None
