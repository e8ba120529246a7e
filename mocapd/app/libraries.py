"""Configures heavy libraries before their import: caches and threads."""

import os
import tempfile
from pathlib import Path

import mocapd
from mocapd.boundary.folders import require_own_folder
from mocapd.errors import PermissionDeniedError, creation_errors


def prepare_libraries(cache_dir: Path) -> None:
    """Before anything imports numba. Raises CannotCreateError when the cache cannot be written,
    PermissionDeniedError when others could write there."""
    import cv2

    use_cache_dir(cache_dir)
    # for tasks under 8 ms the thread pool costs more than it saves
    cv2.setNumThreads(1)


def use_cache_dir(cache_dir: Path) -> None:
    """Makes the folder; numba stores its code there if the package's folder is read-only.

    Call before numba's import, which reads the variable. numba executes cached code, so a folder that others could
    write to is refused. Raises CannotCreateError or PermissionDeniedError.
    """
    _own_folder(cache_dir)
    # empty: beside the kernels; unset, a .numba_config.yaml of the working directory would name a folder
    numba: Path | str = ""
    if not os.access(Path(mocapd.__file__).parent, os.W_OK):
        numba = cache_dir / "numba"
        _own_folder(numba)
    os.environ.setdefault("NUMBA_CACHE_DIR", str(numba))


def _own_folder(path: Path) -> None:
    mend = "make the folder writable, or set cache_dir"
    try:
        with creation_errors(path, mend, "the cache cannot be written"):
            path.mkdir(mode=0o700, parents=True, exist_ok=True)
            require_own_folder(path)
            tempfile.TemporaryFile(dir=path).close()
    except PermissionDeniedError as error:
        raise PermissionDeniedError(
            f"the cache {error.what}", error.where, f"{error.fix} as cache_dir"
        ) from None
