"""Quarantine of unusable files of ours: renamed, so that a new file does not overwrite them."""

import time
from itertools import count
from pathlib import Path
from typing import Literal

Why = Literal["corrupt", "newer"]


def quarantine(path: Path, why: Why = "corrupt") -> Path:
    """Renames a file to NAME.corrupt-TIME, or NAME.newer-TIME for one of a newer mocapd (UTC), readable by its user only.
    Returns the new path; earlier ones stay. Raises OSError."""
    stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
    for number in count(1):
        again = "" if number == 1 else f"-{number}"
        target = path.with_name(f"{path.name}.{why}-{stamp}{again}")
        if not target.exists():
            break
    path.rename(target)
    if target.is_file():
        target.chmod(0o600)
    return target
