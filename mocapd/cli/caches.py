"""Where compiled code and other things that can be made again are kept."""

import os
import tempfile
from pathlib import Path

import mocapd
from mocapd.errors import CannotCreateError


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
