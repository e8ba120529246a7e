"""Ownership and permissions of our folders: trusted content must not be writable by others, private content not
readable."""

import grp
import os
import pwd
import stat
from pathlib import Path

from mocapd.boundary.files import is_folder
from mocapd.errors import CannotCreateError, PermissionDeniedError

_OTHERS = stat.S_IRWXG | stat.S_IRWXO


def private_folder(path: Path) -> None:
    """Makes a private folder, or removes other users' permissions of an existing one. Raises OSError.

    Unchanged are another user's folder, a home, and shared folders such as /tmp.
    """
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    state = path.stat()
    shared = state.st_mode & stat.S_ISVTX or path.resolve() == Path.home()
    if state.st_uid == os.geteuid() and state.st_mode & _OTHERS and not shared:
        path.chmod(stat.S_IMODE(state.st_mode) & ~_OTHERS)


def readable_by_others(path: Path) -> bool:
    """True if another user can read the file or list the folder; False if it does not exist."""
    try:
        return bool(path.stat().st_mode & (stat.S_IRGRP | stat.S_IROTH))
    except (OSError, ValueError):
        return False


def require_own_folder(path: Path) -> None:
    """Checks that only this user can change the folder's content, for files that are executed or trusted.

    Raises PermissionDeniedError that names the other user; OSError when the folder is inaccessible.
    """
    real = path.resolve(strict=True)
    state = real.stat()
    if state.st_uid != os.geteuid():
        raise PermissionDeniedError(
            f"belongs to {_user(state.st_uid)}, whose code this program would run",
            str(path),
            "take a folder of your own",
        )
    if _others_may_write(state):
        raise PermissionDeniedError(
            f"can be written by others (mode {stat.S_IMODE(state.st_mode):04o}), whose code this program would run",
            str(path),
            "empty it and `chmod 700` it, or take a folder of your own",
        )
    for parent in real.parents:
        state = parent.stat()
        if state.st_mode & stat.S_IWOTH and not state.st_mode & stat.S_ISVTX:
            raise PermissionDeniedError(
                f"lies in {parent}, in which every user can replace it",
                str(path),
                "take a folder of your own",
            )


def require_writable(path: Path, setting: str) -> None:
    """Checks that this user can make files in the folder, or the folder itself; makes neither.

    setting: the one that names it. Raises CannotCreateError.
    """
    there = nearest_existing(path)
    if not is_folder(there):
        raise CannotCreateError(
            f"{there} is no folder", str(path), f"move it away, or set {setting} to another"
        )
    if not os.access(there, os.W_OK | os.X_OK):
        raise CannotCreateError(
            "cannot be written to", str(path), f"chown or chmod it, or set {setting} to another"
        )


def nearest_existing(path: Path) -> Path:
    """The folder or what is there in its place, else its nearest existing parent."""
    return next(part for part in (path, *path.parents) if os.path.lexists(part))


def _others_may_write(state: os.stat_result) -> bool:
    if state.st_mode & stat.S_IWOTH:
        return True
    return bool(state.st_mode & stat.S_IWGRP) and not _is_own_group(state.st_gid)


def _is_own_group(gid: int) -> bool:
    """True for the user's private group, which many systems create; their folders have mode 0775."""
    try:
        name, group = pwd.getpwuid(os.geteuid()).pw_name, grp.getgrgid(gid)
    except KeyError:
        return False
    return group.gr_name == name and set(group.gr_mem) <= {name}


def _user(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"uid {uid}"
