"""Files written whole or not at all: beside their place, flushed to the disk, then moved there."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a path beside `path` to write to; that file takes the place of `path` when all went well.

    The name ends as that of `path` does, as some writers ask for. When the block raises, `path` stays
    as it was and nothing is left beside it. Raises OSError: the caller tells what cannot be written.
    """
    # several processes, or threads, may write the same file: the last one's stays
    mark = f"{os.getpid()}.{secrets.token_hex(3)}"
    partial = path.with_name(f".{path.stem}.{mark}{path.suffix}")
    try:
        yield partial
        with partial.open("rb") as file:
            os.fsync(file.fileno())
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
