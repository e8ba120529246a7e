"""Every expected trouble by name. Messages say what went wrong, where, and how to mend it."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT)


def mend_of(error: OSError, otherwise: str) -> str:
    """The mend of a file that cannot be written: room, where that is what lacks."""
    return "make room on that disk" if error.errno in _NO_ROOM else otherwise


def one_line(text: str) -> str:
    """As it may be told in a terminal or a log. Others named what is told of: a file, a webcam, a node of the network, and
    a name may hold line breaks and what a terminal obeys."""
    return text if text.isprintable() else "".join(c if c.isprintable() else " " for c in text)


class MocapdError(Exception):
    """Base of all expected errors, one line each; `exit_code` is what the command line ends with (sysexits)."""

    exit_code = 70

    def __init__(self, what: str, where: str = "", fix: str = "") -> None:
        what, where, fix = map(one_line, (what, where, fix))
        self.what, self.where, self.fix = what, where, fix
        super().__init__((f"{where}: " if where else "") + what + (f" -- {fix}" if fix else ""))


class InputError(MocapdError):
    """A file given by the user is missing, damaged or does not fit (66 EX_NOINPUT)."""

    exit_code = 66


class MalformedError(InputError):
    """Bytes or text from outside are not what they should be; raised by `boundary`, which does not know
    where they came from: whoever reads them says so in an error of its own."""


class ConfigError(MocapdError):
    """A configuration or calibration value is wrong (78 EX_CONFIG)."""

    exit_code = 78


class UsageError(MocapdError):
    """An option or argument of a command is wrong, lacks another or contradicts one (2)."""

    exit_code = 2


@contextmanager
def usage_errors() -> Iterator[None]:
    """For values that the command line alone gives: a ConfigError of the block is raised as a UsageError."""
    try:
        yield
    except ConfigError as error:
        raise UsageError(error.what, error.where, error.fix) from None


class NewerFileError(ConfigError):
    """A file of ours is of a schema that only a newer mocapd reads: never written over, never guessed at (78)."""


class MissingExtraError(ConfigError):
    """A library of an extra is not installed: what only some commands or settings need (78)."""


class UnavailableError(MocapdError):
    """A resource such as a camera, a port or a service is not to be had now (69 EX_UNAVAILABLE)."""

    exit_code = 69


class AmbiguousCameraError(UnavailableError):
    """Several cameras may be the one that is meant: people must say which, by plugging or in the configuration."""


class CannotCreateError(MocapdError):
    """An output file or cache cannot be written (73 EX_CANTCREAT)."""

    exit_code = 73


class PermissionDeniedError(MocapdError):
    """The user lacks a right, such as membership of the group `video` (77 EX_NOPERM)."""

    exit_code = 77


class CameraLost(MocapdError):
    """A camera that was open stopped answering; the capture thread reopens it."""

    exit_code = 69


class EndOfStream(MocapdError):
    """A recorded source has no further frame."""

    exit_code = 0


@dataclass(frozen=True, slots=True)
class Problem:
    """Trouble told to the person: what, where (a camera, a file; may be empty), and how to mend it."""

    what: str
    where: str = ""
    fix: str = ""

    @classmethod
    def of(cls, error: MocapdError) -> "Problem":
        return cls(error.what, error.where, error.fix)
