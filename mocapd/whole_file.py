"""Files written whole or not at all: beside their place, flushed to the disk, then moved there."""

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
    """Yield a path beside `path` to write to; that file takes the place of `path` when all went well.

    The name ends as that of `path` does, as some writers ask for. `private`: nobody else may read it,
    from its first byte on; an earlier one that others could read is replaced. When the block raises,
    `path` stays as it was and nothing is left beside it; what a process that was killed left of it
    goes. Raises OSError: the caller tells what cannot be written.
    """
    # several processes, or threads, may write the same file: the last one's stays
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
    """Remove what killed processes left half written in a folder: of all files, or of those of `stem`.

    now_s: when something was written there. A process may have been given the number of a dead one:
    what is a day older goes too.
    """
    with suppress(OSError):  # it is not there, or not ours to tidy
        for one in folder.iterdir():
            found = _PARTIAL.fullmatch(one.name)
            if found is None or stem not in (None, found[1]):
                continue
            if not _alive(int(found[2])) or one.stat().st_mtime < now_s - _OLD_S:
                one.unlink(missing_ok=True)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # another user's
        return True
    return True
