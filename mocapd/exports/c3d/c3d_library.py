"""ezc3d, the library of the extra `export`. No release has a wheel for Linux on ARM, so mocapd runs without it."""

import sys
from types import ModuleType

from mocapd.errors import UnavailableError


def c3d_library() -> ModuleType:
    """The module ezc3d. Raises UnavailableError where it cannot be imported."""
    try:
        import ezc3d
    except ImportError as error:
        raise UnavailableError(
            f"C3D files need the extra mocapd[export], which is not installed ({error})",
            "--to c3d",
            f"{sys.executable} -m pip install 'ezc3d>=1.5,<2', or export trc, csv, bvh or glb"
            " (on Linux for ARM pip compiles it, with a C++ compiler and cmake)",
        ) from None
    library: ModuleType = ezc3d
    return library
