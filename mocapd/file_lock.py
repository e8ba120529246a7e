"""Lock file by which one process at a time fills a cache; the others wait and then use it."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path


@contextmanager
def one_at_a_time(folder: Path, name: str) -> Iterator[None]:
    """Holds the lock file `name` of a folder, which is created if missing.

    Without support for locks no process waits: each fills its own cache.
    """
    with ExitStack() as held:
        with suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            # does not change an existing file, and follows no link out of the folder
            flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
            lock = os.open(folder / name, flags, 0o600)
            held.callback(os.close, lock)
            fcntl.flock(lock, fcntl.LOCK_EX)  # released by closing, or by the end of the process
        yield
