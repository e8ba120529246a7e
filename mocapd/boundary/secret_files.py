"""Permissions of files with secrets: their readers, and the command that restricts them."""

import grp
import os
import shlex
import stat
from pathlib import Path

# private groups of the services' users
SERVICE_GROUPS = ("mocapd", "mocapd-node")
SERVICE_FOLDER = Path("/etc/mocapd")
_NODE_CONFIG = "camera-node.toml"


def readers_of(path: Path) -> str:
    """The readers of the file besides its owner and our services' groups; empty without any, or without a file."""
    try:
        state = path.stat()
    except (OSError, ValueError):
        return ""
    if state.st_mode & stat.S_IROTH:
        return "every user of this machine"
    if state.st_mode & stat.S_IRGRP and _group_name(state.st_gid) not in SERVICE_GROUPS:
        return "its group"
    return ""


def narrowing(path: Path) -> str:
    """The command that restricts reading to its owner, or to the group of the service that needs it."""
    try:
        is_ours = path.stat().st_uid == os.geteuid()
    except (OSError, ValueError):
        is_ours = True
    if os.geteuid() == 0 and path.absolute().parent == SERVICE_FOLDER:
        return _for_group(path, SERVICE_GROUPS[path.name == _NODE_CONFIG])
    return (
        f"chmod 600 {shlex.quote(str(path))}"
        if is_ours
        else _for_group(path, _group_name(os.getegid()))
    )


def _for_group(path: Path, group: str) -> str:
    sudo, quoted = "" if os.geteuid() == 0 else "sudo ", shlex.quote(str(path))
    return f"{sudo}chown root:{group} {quoted} && {sudo}chmod 640 {quoted}"


def _group_name(gid: int) -> str:
    try:
        return grp.getgrgid(gid).gr_name
    except KeyError:
        return str(gid)
