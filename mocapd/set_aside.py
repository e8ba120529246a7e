"""A file of ours that cannot be used makes room for a new one without being lost: it is kept under a name of its own."""

import time
from itertools import count
from pathlib import Path
from typing import Literal

Why = Literal["corrupt", "newer"]


def set_aside(path: Path, why: Why = "corrupt") -> Path:
    """Rename it to NAME.corrupt-TIME, or NAME.newer-TIME for one of a newer mocapd (UTC), for its user alone; where it
    is then. What was set aside before stays. Raises OSError."""
    stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
    for number in count(1):
        again = "" if number == 1 else f"-{number}"
        aside = path.with_name(f"{path.name}.{why}-{stamp}{again}")
        if not aside.exists():
            break
    path.rename(aside)
    if aside.is_file():
        aside.chmod(0o600)
    return aside
