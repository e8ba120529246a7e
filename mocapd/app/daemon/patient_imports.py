"""Imports in a running service: piece by piece, in idle moments of its pipeline."""

import sys
import threading
import time
from collections.abc import Sequence
from types import ModuleType

from mocapd.pipeline.idle_moments import IdleMoments

_PIECE_S = 0.006  # of imports in one idle moment: they hold Python's lock


class PatientImports:
    """Within this context, this thread waits for an idle moment before it imports a module, after some milliseconds of
    importing. All at once, the page's 240 modules take eight frame sets."""

    def __init__(self, idle: IdleMoments) -> None:
        self._idle = idle
        self._thread, self._until_s = threading.get_ident(), 0.0

    def __enter__(self) -> None:
        sys.meta_path.insert(0, self)

    def __exit__(self, *_: object) -> None:
        sys.meta_path.remove(self)

    def find_spec(
        self, _name: str, _path: Sequence[str] | None, _target: ModuleType | None = None
    ) -> None:
        """Called by the import of each new module, before any other finder; finds nothing."""
        if threading.get_ident() == self._thread and time.monotonic() > self._until_s:
            self._idle.wait()
            self._until_s = time.monotonic() + _PIECE_S
