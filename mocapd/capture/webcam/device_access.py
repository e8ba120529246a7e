"""Checks whether a /dev/video node can be used; the errors say the cause and the fix."""

import errno
import grp
import os
import pwd
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mocapd.capture.webcam.v4l2_ioctl import captures_video, is_streaming_elsewhere
from mocapd.errors import MocapdError, PermissionDeniedError, UnavailableError

PROC = Path("/proc")


@contextmanager
def opened_node(node: Path) -> Iterator[int]:
    """A file descriptor of the node, for queries only.

    Raises UnavailableError (gone) or PermissionDeniedError (with the line that grants the right).
    """
    try:
        fd = os.open(node, os.O_RDWR | os.O_NONBLOCK)
    except OSError as error:
        raise _open_error(node, error) from None
    try:
        yield fd
    finally:
        os.close(fd)


def check_usable(node: Path, fd: int) -> None:
    """Raises UnavailableError when the node does not capture video or is in use."""
    try:
        captures = captures_video(fd)
    except OSError as error:
        if error.errno == errno.ENOTTY:
            raise UnavailableError("not a video node", str(node), "see `mocapd cameras`") from None
        raise UnavailableError(f"does not answer ({error.strerror})", str(node), _REPLUG) from None
    if not captures:
        raise UnavailableError(
            "a metadata node: it delivers no pictures",
            str(node),
            "use the camera's other node, or better its usb: identity",
        )
    if is_streaming_elsewhere(fd):
        raise UnavailableError(
            f"busy: {_holders_text(node)}", str(node), "end that program, or name another camera"
        )


_REPLUG = "unplug the camera and plug it in again"


def _open_error(node: Path, error: OSError) -> MocapdError:
    if error.errno in (errno.ENOENT, errno.ENODEV, errno.ENXIO):
        return UnavailableError("no such camera", str(node), "plug it in; see `mocapd cameras`")
    if error.errno == errno.EACCES:
        return PermissionDeniedError("no permission", str(node), _group_fix(node))
    if error.errno == errno.EPERM:  # the rights would do, the service's device policy forbids it
        return PermissionDeniedError(
            "forbidden by the device policy of the service",
            str(node),
            "the unit needs DeviceAllow=char-video4linux and modprobe@videodev.service; restart it",
        )
    if error.errno == errno.EBUSY:
        return UnavailableError(
            f"busy: {_holders_text(node)}", str(node), "end that program, or name another camera"
        )
    return UnavailableError(f"cannot be opened ({error.strerror})", str(node), _REPLUG)


def _group_fix(node: Path) -> str:
    try:
        return how_to_be_let_in(node, node.stat().st_gid)
    except OSError:
        return _REPLUG


def how_to_be_let_in(node: Path, gid: int) -> str:
    """The fix that gives this user access to a node of this group."""
    if (
        gid == 0
    ):  # udev changes the group a moment after the node appears; never suggest to join root's group
        return f"wait a moment for udev; if it stays so: sudo chgrp video {node}"
    try:
        group = grp.getgrgid(gid).gr_name
    except KeyError:
        group = "video"
    try:
        user = pwd.getpwuid(os.getuid()).pw_name
    except KeyError:
        user = "$USER"
    return f"sudo usermod -aG {group} {user}, then log in again"


def holders(node: Path, proc: Path = PROC) -> tuple[tuple[int, str], ...]:
    """(pid, command) of each process that has the node open, as far as this user may see.

    This process is left out: it has the node open to ask.
    """
    users: list[tuple[int, str]] = []
    for process in proc.glob("[0-9]*"):
        try:
            held = any(link.readlink() == node for link in (process / "fd").iterdir())
            command = (process / "comm").read_text(encoding="utf-8", errors="replace").strip()
        except OSError:  # another user's, or ended while we looked
            continue
        if held and int(process.name) != os.getpid():
            users.append((int(process.name), command))
    return tuple(sorted(users))


def _holders_text(node: Path) -> str:
    users = holders(node)
    if not users:
        return "used by a process of another user, or already by this one"
    return "used by " + ", ".join(f"pid {pid} ({command})" for pid, command in users)
