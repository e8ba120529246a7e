"""The interpreter that a unit starts: the service must have access to it and to mocapd."""

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
    """The running interpreter. Keeps the link of a virtual environment, which `resolve` would leave."""
    return Path(sys.executable)


def required_paths(python: Path) -> tuple[Path, ...]:
    """Paths that the service reads at its start: the interpreter, its link's target, the libraries, mocapd itself."""
    paths = (python, python.resolve(), Path(sys.prefix), Path(sys.base_prefix))
    return (*dict.fromkeys((*paths, Path(mocapd.__file__).parent)),)


def require_visible(paths: Iterable[Path], hidden: Iterable[Path] = HIDDEN) -> None:
    """Raises ConfigError that names a path without access for the service's user, and the reason."""
    for path in paths:
        for folder in hidden:
            if path.is_relative_to(folder):
                raise ConfigError(f"a service does not see {folder}", str(path), _FIX)
        for folder in (path, *path.parents):
            if not _open_to_all(folder):
                raise ConfigError(
                    f"others may not look into {folder}, and a service has a user of its own",
                    *(str(path), _FIX),
                )


def _open_to_all(path: Path) -> bool:
    try:
        return bool(path.stat().st_mode & stat.S_IXOTH)
    except OSError:
        return False
