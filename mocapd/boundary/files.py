"""Reads user-named files: regular files of bounded size with a valid path."""

import os
import stat
from pathlib import Path

from mocapd.boundary.urls import without_password
from mocapd.errors import ConfigError, InputError

_LONGEST_SHOWN = 200
_FIX = "check the path and its rights"


class MissingError(InputError):
    """There is no such file."""


def read_file(path: Path, most_bytes: int) -> bytes:
    """The bytes of a regular file. Raises MissingError, or InputError naming the file.

    A device, a pipe or a socket is refused before reading: /dev/zero has no end, and a pipe without a writer blocks.
    """
    data = read_beginning(path, most_bytes + 1)
    if len(data) > most_bytes:
        raise InputError(f"is larger than {_size(most_bytes)}", str(path), "is it the right file?")
    return data


def _size(number_bytes: int) -> str:
    return f"{number_bytes / 1e6:g} MB" if number_bytes >= 1e6 else f"{number_bytes / 1e3:g} kB"


def read_beginning(path: Path, most_bytes: int) -> bytes:
    """The first bytes of a regular file, all of it when it is shorter. Raises as `read_file`."""
    try:
        # not blocking: opening a pipe would wait for its writer
        with os.fdopen(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as file:
            state = os.fstat(file.fileno())
            if not stat.S_ISREG(state.st_mode):
                raise InputError("is no regular file", str(path), _FIX)
            data: bytes | None = file.read(most_bytes)
            if data is None:  # a file of the kernel or of FUSE that would block
                raise InputError("has nothing to read", str(path), _FIX)
            return data
    except FileNotFoundError:
        if path.exists():  # written a moment after it was looked for
            return read_beginning(path, most_bytes)
        if not is_absent(path):
            raise InputError("is a link that leads to nothing", str(path), _FIX) from None
        raise MissingError("no such file", str(path), "check the path") from None
    except ValueError:  # a NUL in the path
        raise InputError("is no path", repr(str(path)), _FIX) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), _FIX) from None


def read_text(path: Path, most_bytes: int) -> str:
    """A file of UTF-8 text, without its byte order mark. Raises MissingError, or InputError naming the file."""
    try:
        return read_file(path, most_bytes).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"is no UTF-8 text ({error})", str(path), "save it as UTF-8") from None


def user_path(text: str | Path) -> Path:
    """A user's path with `~` expanded. Raises ConfigError for an unknown user, for a NUL, and for bytes that are no
    UTF-8, which neither messages nor a terminal could show."""
    shown = ascii(without_password(str(text)))[:_LONGEST_SHOWN]
    try:
        str(text).encode()
        if "\0" in str(text):  # pathlib takes it, and each use of it raises
            raise ConfigError(f"{shown} is no path", fix="write it without the NUL")
        return Path(text).expanduser()
    except UnicodeEncodeError:
        raise ConfigError(f"{shown} is no UTF-8 text", fix="give it another name") from None
    except RuntimeError:
        raise ConfigError(f"{shown}: there is no such user", fix="write the whole path") from None


def is_absent(path: Path) -> bool:
    """True only when the system reports that the path does not exist.

    False for inaccessible paths: a folder without permission, a dangling link, a loop of links. Reading such a path then
    raises the cause. Where absence means a default, use this function, not `is_file`.
    """
    for part in (path, *path.parents):
        try:
            state = part.lstat()
        except (FileNotFoundError, NotADirectoryError):
            continue
        except (OSError, ValueError):
            return False
        return part != path and not (stat.S_ISLNK(state.st_mode) and _leads_nowhere(part))
    return True


def _leads_nowhere(link: Path) -> bool:
    try:
        link.stat()
    except OSError:
        return True
    return False


def is_file(path: Path) -> bool:
    """True for a regular file; False for an invalid path, where pathlib raises.

    Also False for inaccessible paths: see `is_absent`.
    """
    try:
        return path.is_file()
    except OSError:  # such as a name longer than the file system takes
        return False


def is_folder(path: Path) -> bool:
    """True for a folder; False for an invalid path."""
    try:
        return path.is_dir()
    except OSError:
        return False
