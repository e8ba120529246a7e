"""Exceptions for expected errors. Messages contain the problem, its location, and the fix."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT)


def mend_of(error: OSError, otherwise: str) -> str:
    """The fix for a file that cannot be written: free space if the disk is full."""
    return "make room on that disk" if error.errno in _NO_ROOM else otherwise


def one_line(text: str) -> str:
    """Replaces unprintable characters, for terminals and logs: names of files, webcams and nodes may contain line breaks
    and terminal escapes."""
    return text if text.isprintable() else "".join(c if c.isprintable() else " " for c in text)


class MocapdError(Exception):
    """Base of all expected errors, one line each; `exit_code` is the command's exit code (sysexits)."""

    exit_code = 70

    def __init__(self, what: str, where: str = "", fix: str = "") -> None:
        what, where, fix = map(one_line, (what, where, fix))
        self.what, self.where, self.fix = what, where, fix
        super().__init__((f"{where}: " if where else "") + what + (f" -- {fix}" if fix else ""))


class InputError(MocapdError):
    """A file given by the user is missing, damaged or does not fit (66 EX_NOINPUT)."""

    exit_code = 66


class MalformedError(InputError):
    """Invalid bytes or text from outside; raised by `boundary` without a location, which the caller adds in an error of
    its own."""


class ConfigError(MocapdError):
    """A configuration or calibration value is wrong (78 EX_CONFIG)."""

    exit_code = 78


class UsageError(MocapdError):
    """An option or argument of a command is wrong, lacks another or contradicts one (2)."""

    exit_code = 2


@contextmanager
def usage_errors() -> Iterator[None]:
    """Converts a ConfigError of the block to a UsageError, for values that only the command line gives."""
    try:
        yield
    except ConfigError as error:
        raise UsageError(error.what, error.where, error.fix) from None


class NewerFileError(ConfigError):
    """A file has the schema of a newer mocapd: never overwritten, never guessed at (78)."""


class MissingExtraError(ConfigError):
    """The library of an extra is not installed, which only some commands or settings need (78)."""


class UnavailableError(MocapdError):
    """A resource such as a camera, a port or a service is unavailable (69 EX_UNAVAILABLE)."""

    exit_code = 69


class AmbiguousCameraError(UnavailableError):
    """Several cameras match an identity: the user must decide, by plugging or in the configuration."""


class CannotCreateError(MocapdError):
    """An output file or cache cannot be written (73 EX_CANTCREAT)."""

    exit_code = 73


@contextmanager
def creation_errors(where: object, mend: str, what: str = "cannot be written") -> Iterator[None]:
    """Turns an OSError into a CannotCreateError; mend: the fix, unless the disk is full."""
    try:
        yield
    except OSError as error:
        what = f"{what} ({error.strerror})"
        raise CannotCreateError(what, str(where), mend_of(error, mend)) from None


class PermissionDeniedError(MocapdError):
    """The user lacks a right, such as membership of the group `video` (77 EX_NOPERM)."""

    exit_code = 77


class CameraLost(MocapdError):
    """A camera that was open stopped answering; the capture thread reopens it."""

    exit_code = 69


class CameraClosed(CameraLost):
    """It was closed on request, as to open it in another mode: no failure."""


class EndOfStream(MocapdError):
    """A recorded source has no further frame."""

    exit_code = 0


@dataclass(frozen=True, slots=True)
class Problem:
    """Trouble for the user: the problem, its location (a camera, a file; may be empty), and the fix."""

    what: str
    where: str = ""
    fix: str = ""

    @classmethod
    def of(cls, error: MocapdError) -> "Problem":
        return cls(error.what, error.where, error.fix)
