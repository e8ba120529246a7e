"""What must be set before the heavy libraries are at work: caches and threads."""

import os
import tempfile
from pathlib import Path

import mocapd
from mocapd.errors import CannotCreateError


def prepare_libraries(cache_dir: Path) -> None:
    """Before anything imports numba. Raises CannotCreateError when the cache cannot be written."""
    import cv2

    use_cache_dir(cache_dir)
    # a task of under 8 ms waits longer for a pool of threads than it takes
    cv2.setNumThreads(1)


def use_cache_dir(cache_dir: Path) -> None:
    """Make the folder, and have numba keep its code there when it cannot beside the source.

    Before anything imports numba, which reads the variable then. Raises CannotCreateError.
    """
    try:
        cache_dir.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=cache_dir).close()
    except OSError as error:
        raise CannotCreateError(
            f"the cache cannot be written ({error.strerror})",
            str(cache_dir),
            "make the folder writable, or set cache_dir",
        ) from None
    package = Path(mocapd.__file__).parent
    if not os.access(package, os.W_OK):
        os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_dir / "numba"))
