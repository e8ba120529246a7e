"""A key that is made once, and kept in the state directory for our user alone: who has it is let in to one thing."""

import re
import secrets
from pathlib import Path

from mocapd.boundary.files import MissingError, read_text
from mocapd.errors import CannotCreateError, InputError, mend_of
from mocapd.whole_file import whole_file

_KEY = re.compile(r"[A-Za-z0-9_-]{32}")
_LONGEST_FILE = 1 << 10  # [bytes]


def new_key() -> str:
    """One that nobody can guess."""
    return secrets.token_urlsafe(24)


def kept_key(path: Path) -> str:
    """The key of the file, which is made if need be. Raises InputError for one that holds no key,
    CannotCreateError."""
    try:
        key = read_text(path, _LONGEST_FILE).strip()
    except MissingError:
        return _made(path)
    if not _KEY.fullmatch(key):
        raise InputError("holds no key", str(path), "remove it: the next start makes another")
    return key


def _made(path: Path) -> str:
    key = new_key()
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(path, private=True) as partial:
            partial.write_text(f"{key}\n", encoding="ascii")
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written: {error.strerror}",
            str(path),
            mend_of(error, "let this user write there"),
        ) from error
    return key
