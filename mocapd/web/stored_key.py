"""An access key that is made once and stored in the state directory, readable by our user only."""

import re
import secrets
from pathlib import Path

from mocapd.boundary.files import MissingError, read_text
from mocapd.errors import InputError, creation_errors
from mocapd.whole_file import whole_file

_KEY = re.compile(r"[A-Za-z0-9_-]{32}")
_LONGEST_FILE = 1 << 10  # [bytes]


def same_secret(given: str, secret: str) -> bool:
    """Compares in a time that says nothing of the secret."""
    return secrets.compare_digest(given.encode(errors="replace"), secret.encode())


def key_of(state_dir: Path | None, name: str) -> str:
    """The stored key of this name, or a temporary one without a folder. Raises as `stored_key`."""
    return _new_key() if state_dir is None else stored_key(state_dir / name)


def stored_key(path: Path) -> str:
    """The key in the file, which it makes if missing. Raises InputError for a file without a valid key,
    CannotCreateError."""
    try:
        key = read_text(path, _LONGEST_FILE).strip()
    except MissingError:
        return _make(path)
    if not _KEY.fullmatch(key):
        raise InputError("holds no key", str(path), "remove it: the next start makes another")
    return key


def _make(path: Path) -> str:
    key = _new_key()
    with creation_errors(path, "let this user write there"):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(path, private=True) as partial:
            partial.write_text(f"{key}\n", encoding="ascii")
    return key


def _new_key() -> str:
    return secrets.token_urlsafe(24)
