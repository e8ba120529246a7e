"""Facts of mocapd's folders: permissions and free space."""

import os
import shutil
from dataclasses import replace
from pathlib import Path

from mocapd.boundary.files import is_folder
from mocapd.boundary.folders import readable_by_others, require_own_folder
from mocapd.config.runtime_folder import runtime_folder
from mocapd.config.sections import Config
from mocapd.doctor.facts import FolderFacts
from mocapd.errors import MocapdError, Problem


def folder_facts(config: Config) -> tuple[FolderFacts, ...]:
    """Facts of the cache, state and runtime folders; creates none."""
    return (
        _folder("cache_dir", config.cache_dir, runs_from_it=True),
        _folder("state_dir", config.state_dir),
        # systemd limits it to a tenth of the memory
        replace(
            _folder("XDG_RUNTIME_DIR", runtime_folder(config.state_dir)),
            holds_little=True,
        ),
    )


def _folder(key: str, path: Path, runs_from_it: bool = False) -> FolderFacts:
    there = _nearest(path)
    trouble = None
    if not is_folder(there):
        trouble = Problem(f"{there} is no folder", fix=f"move it away, or set {key} to another")
    elif runs_from_it and there == path:
        try:
            require_own_folder(path)
        except MocapdError as error:
            trouble = Problem.of(error)
    if trouble is None and not os.access(there, os.W_OK | os.X_OK):
        trouble = Problem("cannot be written to", fix=f"chown or chmod it, or set {key} to another")
    try:
        free: int | None = shutil.disk_usage(there).free
    except OSError:
        free = None
    # the cache holds no secrets
    secret = not runs_from_it and there == path
    return FolderFacts(key, path, trouble, secret and readable_by_others(path), free)


def _nearest(path: Path) -> Path:
    """The folder or what is there in its place, else its nearest existing parent."""
    return next(part for part in (path, *path.parents) if os.path.lexists(part))
