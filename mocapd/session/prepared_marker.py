"""Marker file in the cache folder: one fingerprint per line of code and configuration that were prepared."""

import hashlib
import logging
import os
import platform
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import mocapd
from mocapd.boundary.files import read_text
from mocapd.capture.kinds.source_kinds import is_simulated
from mocapd.errors import InputError
from mocapd.whole_file import whole_file

if TYPE_CHECKING:
    from mocapd.config.sections import Config

MARKER = "prepared"
LOCK = "prepared.lock"  # held during preparation
REMEMBERED = 32  # a tracker has four: real cameras or simulated, all or the database
_MOST_BYTES = 1 << 16

_log = logging.getLogger(__name__)


def is_prepared(config: "Config", what: str = "") -> bool:
    """True if this code was prepared with this tracker; `what`: a part of it, everything when empty. False for an
    unreadable marker, so that everything is prepared again."""
    return _fingerprint(config, what) in _read_fingerprints(config.cache_dir / MARKER)


def remember(config: "Config", what: str = "") -> None:
    """Marks it as prepared. Logs a warning when the marker cannot be written."""
    marker = config.cache_dir / MARKER
    # what is prepared for simulated webcams includes what real ones need
    now = {_fingerprint(config, what), _fingerprint(replace(config, camera=()), what)}
    done = _read_fingerprints(marker)
    new = sorted(now.difference(done))
    if not new:
        return
    try:
        with whole_file(marker) as partial:
            partial.write_text("\n".join([*done, *new][-REMEMBERED:]) + "\n", "utf-8")
    except OSError as error:
        _log.warning(
            "%s cannot be written (%s): the next start prepares everything again",
            *(marker, error.strerror),
        )


def _read_fingerprints(marker: Path) -> list[str]:
    try:
        return read_text(marker, _MOST_BYTES).split()
    except InputError:
        return []


def _fingerprint(config: "Config", what: str) -> str:
    """Hash of everything that compiled code and caches depend on."""
    digest = hashlib.sha256()
    for source in sorted(_sources(str(Path(mocapd.__file__).parent)), key=lambda one: one.path):
        stat = source.stat()
        digest.update(f"{source.path} {stat.st_size} {stat.st_mtime_ns}\n".encode())
    # the renderer is compiled for simulated webcams only
    tracker = config.tracker.name
    if any(is_simulated(camera.source) for camera in config.camera):
        tracker += " simulated"
    digest.update(f"{platform.python_version()} {version('numba')} {tracker}{what}".encode())
    return digest.hexdigest()


def _sources(folder: str) -> Iterator[os.DirEntry[str]]:
    """Python files in a folder and its folders, in any order; twice as fast as `Path.rglob`."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                yield entry
            elif entry.is_dir() and entry.name != "__pycache__":
                yield from _sources(entry.path)
