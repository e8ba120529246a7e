"""Where numba keeps a kernel's compiled code, and until when that is good: until the kernel, or one it calls, changes.

numba's own cache is good until the kernel's file changes: an upgrade that touches a comment compiles anew, and one
that touches a callee in another file goes on with the old code. The package's `__init__.py` names it to numba before its own
classes, so that other packages' functions are kept as ever.
"""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

import numba
import numpy as np
from numba.core import config
from numba.core.caching import Cache, _CacheLocator
from numba.core.runtime.nrt import rtsys

import mocapd
from mocapd.kernels.callees import content_of

_PACKAGE = Path(mocapd.__file__).resolve().parent
_config: Any = config  # its settings carry no types
_OLD_S = 30 * 86400.0
_LETTERS = 16  # of the hash, in a file's name


def _load(cache: Any, signature: Any, context: Any) -> Any:
    """numba's `Cache.load_overload` without refreshing the context: that imports all of the compiler and scipy's linear
    algebra, for a third of a second at each start. Compiling refreshes it, if something is not cached."""
    rtsys.initialize(context)
    return cache._load_overload(signature, context)


Cache.load_overload = _load  # type: ignore[method-assign]


class KernelLocator(_CacheLocator):
    """See numba's `_CacheLocator`. Kernels of other contents have files of other names, so that a
    checkout's branches do not take each other's."""

    def __init__(self, function: Callable[..., Any], file: Path) -> None:
        self._py_file, self._function = str(file), function
        beside = file.parent / "__pycache__"
        place = "_".join(file.parent.relative_to(_PACKAGE.parent).parts)
        told = _config.CACHE_DIR
        self._path = Path(told) / place if told else beside

    def get_cache_path(self) -> str:
        """In the folder that numba was told, by the package's names; else in __pycache__."""
        return str(self._path)

    def get_source_stamp(self) -> tuple[str, ...]:
        """Of kernel, callees and compiler."""
        return (content_of(self._function), numba.__version__, np.__version__)

    def get_disambiguator(self) -> str:
        """Part of the file's name."""
        return content_of(self._function)[:_LETTERS]

    def remove_old(self, now_s: float) -> None:
        """What is kept of other contents of this kernel, when it has not been written for a month: versions that are gone."""
        name = f"{Path(self._py_file).stem}.{self._function.__qualname__}-"
        for path in self._path.glob(f"{name}*.nb[ci]"):
            with suppress(OSError):  # somebody else's, or removed by another start
                if (
                    self.get_disambiguator() not in path.name
                    and now_s - path.stat().st_mtime > _OLD_S
                ):
                    path.unlink()

    def _ensure(self) -> None:
        ensure: Any = self.ensure_cache_path
        ensure()

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Self | None:
        """None for functions that are not mocapd's, and where nothing can be written."""
        file = Path(py_file).resolve()
        if _PACKAGE not in file.parents:
            return None
        found = cls(py_func, file)
        try:
            found._ensure()
        except OSError:
            return None
        return found
