"""Facts of mocapd's folders: permissions and free space."""

import shutil
from dataclasses import replace
from pathlib import Path

from mocapd.boundary.folders import (
    nearest_existing,
    readable_by_others,
    require_own_folder,
    require_writable,
)
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
    there = nearest_existing(path)
    trouble = None
    try:
        require_writable(path, key)
        if runs_from_it and there == path:
            require_own_folder(path)
    except MocapdError as error:
        trouble = Problem(error.what, fix=error.fix)
    try:
        free: int | None = shutil.disk_usage(there).free
    except OSError:
        free = None
    # the cache holds no secrets
    secret = not runs_from_it and there == path
    return FolderFacts(key, path, trouble, secret and readable_by_others(path), free)
