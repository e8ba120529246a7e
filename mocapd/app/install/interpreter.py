"""The interpreter that a unit starts: it, and mocapd, must be where the service may look."""

import stat
import sys
from collections.abc import Iterable
from pathlib import Path

import mocapd
from mocapd.errors import ConfigError

# what ProtectHome= and PrivateTmp= hide from the service
HIDDEN = tuple(map(Path, ("/home", "/root", "/run/user", "/tmp", "/var/tmp")))
_FIX = (
    "install mocapd for all users: in its checkout `make dist`, then `python3 -m venv /opt/mocapd &&"
    " /opt/mocapd/bin/pip install dist/mocapd-*.whl`, and run `/opt/mocapd/bin/mocapd install-service`; or take --user"
)


def own() -> Path:
    """That which runs this, in its own environment: a link is not followed, as it would lead out of that."""
    return Path(sys.executable)


def needed(python: Path) -> tuple[Path, ...]:
    """What the service reads at its start: the interpreter, what it is a link to, the libraries, mocapd itself."""
    found = (python, python.resolve(), Path(sys.prefix), Path(sys.base_prefix))
    return (*dict.fromkeys((*found, Path(mocapd.__file__).parent)),)


def require_visible(paths: Iterable[Path], hidden: Iterable[Path] = HIDDEN) -> None:
    """Raises ConfigError naming what a service of its own user cannot read, and why."""
    for path in paths:
        for one in hidden:
            if path.is_relative_to(one):
                raise ConfigError(f"a service does not see {one}", str(path), _FIX)
        for one in (path, *path.parents):
            if not _open_to_all(one):
                raise ConfigError(
                    f"others may not look into {one}, and a service has a user of its own",
                    *(str(path), _FIX),
                )


def _open_to_all(path: Path) -> bool:
    try:
        return bool(path.stat().st_mode & stat.S_IXOTH)
    except OSError:
        return False
