"""Atomic writes: to a temporary file in the same folder, flushed to the disk, then renamed."""

import os
import re
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_PARTIAL = re.compile(r"\.(.+)\.([1-9]\d{0,9})\.[0-9a-f]{6}(\.\w+)?")
_OLD_S = 24 * 3600.0  # no file takes that long to write


@contextmanager
def whole_file(path: Path, private: bool = False) -> Iterator[Path]:
    """Yields a temporary path in the same folder, which atomically replaces `path` on success.

    The name has the suffix of `path`, which some writers require. `private`: readable by this user only, from the first
    byte on; replaces a readable earlier file. When the block raises, `path` is unchanged and the temporary file removed;
    files left by killed processes are removed too. Raises OSError.
    """
    # several processes or threads may write the same file: the last one wins
    mark = f"{os.getpid()}.{secrets.token_hex(3)}"
    partial = path.with_name(f".{path.stem}.{mark}{path.suffix}")
    try:
        if private:
            os.close(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600))
        yield partial
        with partial.open("rb") as file:
            os.fsync(file.fileno())
        partial.replace(path)
        tidy(path.parent, path.stat().st_mtime, path.stem)
    finally:
        partial.unlink(missing_ok=True)


def tidy(folder: Path, now_s: float, stem: str | None = None) -> None:
    """Removes temporary files of killed processes from a folder: all, or those of `stem`.

    now_s: time of a recent write there. Also removes files a day older, as a new process may have a dead one's pid.
    """
    with suppress(OSError):  # absent, or without permission
        for file in folder.iterdir():
            name = _PARTIAL.fullmatch(file.name)
            if name is None or stem not in (None, name[1]):
                continue
            if not _alive(int(name[2])) or file.stat().st_mtime < now_s - _OLD_S:
                file.unlink(missing_ok=True)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # another user's
        return True
    return True
