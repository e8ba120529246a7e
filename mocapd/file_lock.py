"""One process at a time makes what is kept in a cache; the others wait, and find it there."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path


@contextmanager
def one_at_a_time(folder: Path, name: str) -> Iterator[None]:
    """Hold the lock file `name` of a folder, which is made if need be, once nobody else does.

    Where no lock can be had nobody waits: each makes its own.
    """
    with ExitStack() as held:
        with suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            # whatever is there stays as it is, and nothing beyond the folder is touched
            flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
            lock = os.open(folder / name, flags, 0o600)
            held.callback(os.close, lock)
            fcntl.flock(lock, fcntl.LOCK_EX)  # let go when it is closed, or the process is gone
        yield
