"""Where control sockets are: one for each process, named by its id, for its user alone."""

import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

SYSTEM = Path("/run")  # where systemd puts the runtime directories of its services
_ROOT = 0
_LOOK = os.R_OK | os.X_OK
_CREDENTIALS = struct.Struct("3i")  # pid, uid, gid of SO_PEERCRED


def socket_path(folder: Path, pid: int) -> Path:
    """Of the process; folder: see `config.runtime_folder`."""
    return folder / f"control-{pid}.sock"


def sockets_in(folder: Path) -> tuple[Path, ...]:
    """Those that processes have made there, and perhaps left."""
    return tuple(sorted(folder.glob("control-*.sock")))


def service_sockets(system: Path = SYSTEM) -> tuple[Path, ...]:
    """Of daemons that systemd has started: RuntimeDirectory=mocapd, mocapd-NAME or mocapd/NAME."""
    found = (sockets_in(one) for one in _service_folders(system) if os.access(one, _LOOK))
    return tuple(sorted(path for paths in found for path in paths))


def closed_folders(system: Path = SYSTEM) -> tuple[Path, ...]:
    """Runtime directories of running services that our user may not look into; systemd removes them with the service."""
    return tuple(one for one in _service_folders(system) if not os.access(one, _LOOK))


def _service_folders(system: Path) -> Iterator[Path]:
    """Whether our user may look into them or not."""
    # not by glob(), which ends at the first link into a folder that is closed
    for folder in _folders_in(system):
        if folder.name == "mocapd" or folder.name.startswith("mocapd-"):
            yield from (folder, *_folders_in(folder))


def _folders_in(path: Path) -> list[Path]:
    """By name, and links; none of a folder that is closed or gone."""
    with suppress(OSError), os.scandir(path) as found:
        kept = (one for one in found if one.is_symlink() or one.is_dir(follow_symlinks=False))
        return sorted(Path(one.path) for one in kept)
    return []


@contextmanager
def short_address(path: Path) -> Iterator[str]:
    """An address for the path, which itself may be longer than the 107 bytes that a Unix socket's address takes.
    Raises OSError."""
    folder = os.open(path.parent, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)


def peer_of(connection: socket.socket) -> int:
    """The user id of the process at the other end."""
    told = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    uid: int = _CREDENTIALS.unpack(told)[1]
    return uid


def may_command(uid: int) -> bool:
    """Whether this user may tell our process what to do: ours, and root, who may do everything anyhow."""
    return uid in (os.geteuid(), _ROOT)
