"""Paths of control sockets: one per process, named by its pid, accessible to its user only."""

import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mocapd.boundary.files import is_folder

SYSTEM = Path("/run")  # where systemd puts the runtime directories of its services
_ROOT = 0
_LOOK = os.R_OK | os.X_OK
_CREDENTIALS = struct.Struct("3i")  # pid, uid, gid of SO_PEERCRED


def socket_path(folder: Path, pid: int) -> Path:
    """The socket of a process; folder: see `config.runtime_folder`."""
    return folder / f"control-{pid}.sock"


def sockets_in(folder: Path) -> tuple[Path, ...]:
    """The sockets in a folder, stale ones included; none in a folder that another user has closed to us."""
    return tuple(sorted(folder.glob("control-*.sock"))) if is_folder(folder) else ()


def service_sockets(system: Path = SYSTEM) -> tuple[Path, ...]:
    """Sockets of daemons that systemd started: RuntimeDirectory=mocapd, mocapd-NAME or mocapd/NAME."""
    folders = (folder for folder in _service_folders(system) if os.access(folder, _LOOK))
    return tuple(sorted(path for folder in folders for path in sockets_in(folder)))


def closed_folders(system: Path = SYSTEM) -> tuple[Path, ...]:
    """Runtime directories of running services without access for our user; systemd removes them with the service."""
    return tuple(path for path in _service_folders(system) if not os.access(path, _LOOK))


def _service_folders(system: Path) -> Iterator[Path]:
    """Runtime directories, with or without access for our user."""
    # not by glob(), which stops at the first link into an inaccessible folder
    for folder in _folders_in(system):
        if folder.name == "mocapd" or folder.name.startswith("mocapd-"):
            yield from (folder, *_folders_in(folder))


def _folders_in(path: Path) -> list[Path]:
    """Subfolders and links by name; empty for an inaccessible or missing folder."""
    with suppress(OSError), os.scandir(path) as entries:
        folders = (e for e in entries if e.is_symlink() or e.is_dir(follow_symlinks=False))
        return sorted(Path(entry.path) for entry in folders)
    return []


@contextmanager
def short_address(path: Path) -> Iterator[str]:
    """A short alias of the path, which may exceed the 107 bytes of a Unix socket's address.
    Raises OSError."""
    folder = os.open(path.parent, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)


def peer_of(connection: socket.socket) -> int:
    """The user id of the process at the other end."""
    credentials = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    uid: int = _CREDENTIALS.unpack(credentials)[1]
    return uid


def may_command(uid: int) -> bool:
    """True for users that may command this process: its own, and root."""
    return uid in (os.geteuid(), _ROOT)
