"""The simulator's cache files: a checksum, then msgpack. A file is read only if checksum and key match."""

import os
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Protocol, TypeVar

import msgspec

from mocapd.boundary.files import read_file
from mocapd.boundary.parsing import decode_msgpack
from mocapd.errors import InputError, creation_errors
from mocapd.file_lock import one_at_a_time
from mocapd.whole_file import whole_file

_CHECKSUM_BYTES = 4
_KEY_LETTERS = 16  # of a key in a file's name
_UNUSED_S = 7 * 86_400.0
_MOST_BYTES = 4 << 30  # two minutes of the largest pictures


class Keyed(Protocol):
    """key: a hash of everything the file was made from."""

    @property
    def key(self) -> str: ...


F = TypeVar("F", bound=Keyed)


def cache_path(folder: Path, name: str, key: str) -> Path:
    """The file of this name and key."""
    return folder / f"{name}-{key[:_KEY_LETTERS]}.film"


def read_or_make(folder: Path, name: str, key: str, kind: type[F], make: Callable[[], F]) -> F:
    """The cached file, or the result of `make`, which is stored; files of the name that were not used for a week are then
    removed, as those of versions before an upgrade.

    Of several processes only one makes it. Raises CannotCreateError.
    """
    path = cache_path(folder, name, key)
    stored = read_cached(path, key, kind)
    if stored is not None:
        with suppress(OSError):  # its time is that of its last use
            os.utime(path)
        return stored
    with one_at_a_time(folder, f"{name}.lock"):
        stored = read_cached(path, key, kind)  # another process may have made it meanwhile
        if stored is None:
            stored = make()
            write_cached(path, stored)
            _remove_unused(folder, name)
        return stored


def _remove_unused(folder: Path, name: str) -> None:
    oldest_s = time.time() - _UNUSED_S
    with suppress(OSError):
        for path in folder.glob(f"{name}-{'?' * _KEY_LETTERS}.film"):
            if path.stat().st_mtime < oldest_s:
                path.unlink(missing_ok=True)


def read_cached(path: Path, key: str, kind: type[F]) -> F | None:
    """The cached file; None if it is absent, has another key or is damaged."""
    try:
        data = memoryview(read_file(path, _MOST_BYTES))
        if _checksum(data[_CHECKSUM_BYTES:]) != data[:_CHECKSUM_BYTES]:
            return None
        stored = decode_msgpack(data[_CHECKSUM_BYTES:], kind)
    except InputError:
        return None
    return stored if stored.key == key else None


def write_cached(path: Path, file: Keyed) -> None:
    """Atomic write. Raises CannotCreateError."""
    data = msgspec.msgpack.encode(file)
    mend = "choose another cache directory"
    with creation_errors(path, mend, "the simulator's cache cannot be written"):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(path) as partial, partial.open("wb") as out:
            out.write(_checksum(data))
            out.write(data)


def _checksum(data: bytes | memoryview) -> bytes:
    """Against damage; a film has some 40 MB, and a digest of them would take three times as long at each start."""
    return zlib.crc32(data).to_bytes(_CHECKSUM_BYTES, "little")
