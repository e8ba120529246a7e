"""Folders of ours: what lies in them is believed, or is nobody else's business."""

import grp
import os
import pwd
import stat
from pathlib import Path

from mocapd.errors import PermissionDeniedError

_OTHERS = stat.S_IRWXG | stat.S_IRWXO


def private_folder(path: Path) -> None:
    """Make the folder for us alone, or narrow what an earlier version made for all. Raises OSError.

    Left as they are: another user's, a home, and one that everybody may use, such as /tmp.
    """
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    told = path.stat()
    shared = told.st_mode & stat.S_ISVTX or path.resolve() == Path.home()
    if told.st_uid == os.geteuid() and told.st_mode & _OTHERS and not shared:
        path.chmod(stat.S_IMODE(told.st_mode) & ~_OTHERS)


def readable_by_others(path: Path) -> bool:
    """Whether somebody else could read the file, or list the folder; no where there is none."""
    try:
        return bool(path.stat().st_mode & (stat.S_IRGRP | stat.S_IROTH))
    except (OSError, ValueError):
        return False


def require_own_folder(path: Path) -> None:
    """That nobody else can change what lies in the folder, for files that are run or believed.

    Raises PermissionDeniedError naming who could; OSError when it cannot be looked at.
    """
    real = path.resolve(strict=True)
    told = real.stat()
    if told.st_uid != os.geteuid():
        raise PermissionDeniedError(
            f"belongs to {_user(told.st_uid)}, who could have this program run anything",
            str(path),
            "take a folder of your own",
        )
    if _others_may_write(told):
        raise PermissionDeniedError(
            f"can be written by others (mode {stat.S_IMODE(told.st_mode):04o}), who could have this"
            " program run anything",
            str(path),
            "empty it and `chmod 700` it, or take a folder of your own",
        )
    for one in real.parents:
        told = one.stat()
        if told.st_mode & stat.S_IWOTH and not told.st_mode & stat.S_ISVTX:
            raise PermissionDeniedError(
                f"lies in {one}, in which everybody may put another in its place",
                str(path),
                "take a folder of your own",
            )


def _others_may_write(told: os.stat_result) -> bool:
    if told.st_mode & stat.S_IWOTH:
        return True
    return bool(told.st_mode & stat.S_IWGRP) and not _is_own_group(told.st_gid)


def _is_own_group(gid: int) -> bool:
    """Whether it is the group that many systems give each user, whose folders are 0775."""
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
