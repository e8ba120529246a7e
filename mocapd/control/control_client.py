"""A command's end of the control socket: finds running daemons, and asks them."""

import os
import socket
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from mocapd.boundary.parsing import decode_json
from mocapd.control.control_messages import (
    Answer,
    Recentered,
    Refused,
    Reloaded,
    Request,
    StatusReport,
    Verb,
)
from mocapd.control.line import read_line
from mocapd.control.socket_place import (
    closed_folders,
    may_command,
    peer_of,
    service_sockets,
    short_address,
    sockets_in,
)
from mocapd.errors import (
    CannotCreateError,
    ConfigError,
    InputError,
    MalformedError,
    MocapdError,
    PermissionDeniedError,
    UnavailableError,
)

T = TypeVar("T", StatusReport, Recentered, Reloaded)

ANSWER_S = 5.0  # how long a living daemon may take to answer [s]
RELOAD_S = 300.0  # and to prepare another session; kernels may have to be compiled for it [s]
_LONGEST_ANSWER = 1 << 20  # [bytes]

_BY_EXIT_CODE: dict[int, type[MocapdError]] = {
    kind.exit_code: kind
    for kind in (
        InputError,
        ConfigError,
        UnavailableError,
        CannotCreateError,
        PermissionDeniedError,
    )
}


@dataclass(frozen=True, slots=True)
class Found:
    """Daemons that answered, and sockets of living ones that did not: `silent` gave no answer, `foreign` are of
    another user, who may be asked by root alone, or the folder in which that user's lie."""

    daemons: "tuple[RunningDaemon, ...]" = ()
    silent: tuple[Path, ...] = ()
    foreign: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class RunningDaemon:
    """One that answers, and what it said."""

    path: Path
    status: StatusReport

    @property
    def instance(self) -> str:
        """Its name in the keys."""
        return self.status.instance

    @property
    def state_dir(self) -> str:
        """Where its calibration is kept."""
        return self.status.state_dir

    def recenter(self) -> Recentered:
        """Have it make forward what the person faces. Raises MocapdError with its own words."""
        return _asked(self.path, "recenter", Recentered, ANSWER_S)

    def reload(self) -> Reloaded:
        """Have it read its configuration again. Raises MocapdError with its own words: it goes on as it was."""
        return _asked(self.path, "reload", Reloaded, RELOAD_S)


class _ForeignError(UnavailableError):
    """The socket is another user's."""

    def __init__(self, path: Path) -> None:
        super().__init__("is another user's", str(path), "ask as that user, or as root")


class _DeadError(UnavailableError):
    """Nobody listens there any more."""

    def __init__(self, path: Path) -> None:
        super().__init__("has ended", str(path), "start it anew")


def running_daemons(folders: Iterable[Path], services: Iterable[Path] | None = None) -> Found:
    """Those of our user's folders, and the machine's services. Sockets that a killed process has left in those
    folders are removed."""
    found: list[RunningDaemon] = []
    silent: list[Path] = []
    foreign = list(closed_folders()) if services is None else []
    own = [path for folder in folders for path in sockets_in(folder)]
    theirs = service_sockets() if services is None else services
    for path in dict.fromkeys((*own, *theirs)):
        try:
            found.append(RunningDaemon(path, _asked(path, "status", StatusReport, ANSWER_S)))
        except _ForeignError:
            foreign.append(path)
        except _DeadError:
            if path in own:
                with suppress(OSError):
                    path.unlink()
        except UnavailableError:
            silent.append(path)
    return Found(tuple(found), tuple(silent), tuple(foreign))


def _asked(path: Path, verb: Verb, kind: type[T], within_s: float) -> T:
    """Raises MocapdError."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
            connection.settimeout(within_s)
            _connect(connection, path)
            connection.sendall(msgspec.json.encode(Request(verb)) + b"\n")
            answer = decode_json(read_line(connection, _LONGEST_ANSWER, within_s), Answer)
            if answer.refused is None:
                return decode_json(bytes(answer.told), kind)
    except TimeoutError:
        raise UnavailableError(
            f"does not answer within {within_s:g} s", str(path), "start it anew"
        ) from None
    except MalformedError as error:
        raise UnavailableError(
            f"its answer is not understood: {error.what}",
            str(path),
            "bring it and this command to the same version of mocapd",
        ) from None
    except OSError as error:
        raise UnavailableError(f"no answer: {error.strerror}", str(path), "start it anew") from None
    raise _named(answer.refused)


def _connect(connection: socket.socket, path: Path) -> None:
    try:
        with short_address(path) as address:
            connection.connect(address)
    except PermissionError:
        raise _ForeignError(path) from None
    except (ConnectionRefusedError, FileNotFoundError):
        raise _DeadError(path) from None
    # root asks everybody; nobody else believes what another user's process says
    if not (os.geteuid() == 0 or may_command(peer_of(connection))):
        raise _ForeignError(path)


def _named(refused: Refused) -> MocapdError:
    kind = _BY_EXIT_CODE.get(refused.exit_code, UnavailableError)
    return kind(refused.what, refused.where, refused.fix)
