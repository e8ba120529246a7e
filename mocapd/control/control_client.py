"""Client of the control socket: finds running daemons and sends them requests."""

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

ANSWER_S = 5.0  # timeout of an answer [s]
RELOAD_S = 300.0  # timeout of a reload, which may compile kernels [s]
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
class FoundDaemons:
    """Daemons that answered, and sockets of others: `silent` did not answer, `foreign` (sockets or their folder) belong to
    another user and answer to root only."""

    daemons: "tuple[RunningDaemon, ...]" = ()
    silent: tuple[Path, ...] = ()
    foreign: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class RunningDaemon:
    """A daemon that answers, and its status."""

    path: Path
    status: StatusReport

    @property
    def instance(self) -> str:
        """Its name in the keys."""
        return self.status.instance

    @property
    def state_dir(self) -> str:
        """The folder of its calibration."""
        return self.status.state_dir

    def recenter(self) -> Recentered:
        """Makes the person's heading forward. Raises the daemon's MocapdError."""
        return _request(self.path, "recenter", Recentered, ANSWER_S)

    def reload(self) -> Reloaded:
        """Reloads the configuration. Raises the daemon's MocapdError; it then continues unchanged."""
        return _request(self.path, "reload", Reloaded, RELOAD_S)


class _ForeignError(UnavailableError):
    """The socket belongs to another user."""

    def __init__(self, path: Path) -> None:
        super().__init__("is another user's", str(path), "ask as that user, or as root")


class _DeadError(UnavailableError):
    """No process listens at the socket."""

    def __init__(self, path: Path) -> None:
        super().__init__("has ended", str(path), "restart it")


def running_daemons(
    folders: Iterable[Path], services: Iterable[Path] | None = None
) -> FoundDaemons:
    """Daemons of the user's folders, and the machine's services. Removes stale sockets from the folders."""
    daemons: list[RunningDaemon] = []
    silent: list[Path] = []
    foreign = list(closed_folders()) if services is None else []
    own = [path for folder in folders for path in sockets_in(folder)]
    theirs = service_sockets() if services is None else services
    for path in dict.fromkeys((*own, *theirs)):
        try:
            daemons.append(RunningDaemon(path, _request(path, "status", StatusReport, ANSWER_S)))
        except _ForeignError:
            foreign.append(path)
        except _DeadError:
            if path in own:
                with suppress(OSError):
                    path.unlink()
        except UnavailableError:
            silent.append(path)
    return FoundDaemons(tuple(daemons), tuple(silent), tuple(foreign))


def _request(path: Path, verb: Verb, kind: type[T], within_s: float) -> T:
    """Sends a request and returns its answer. Raises MocapdError."""
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
            f"does not answer within {within_s:g} s", str(path), "restart it"
        ) from None
    except MalformedError as error:
        raise UnavailableError(
            f"its answer is not understood: {error.what}",
            str(path),
            "bring it and this command to the same version of mocapd",
        ) from None
    except OSError as error:
        raise UnavailableError(f"no answer: {error.strerror}", str(path), "restart it") from None
    raise _error_of(answer.refused)


def _connect(connection: socket.socket, path: Path) -> None:
    try:
        with short_address(path) as address:
            connection.connect(address)
    except PermissionError:
        raise _ForeignError(path) from None
    except (ConnectionRefusedError, FileNotFoundError):
        raise _DeadError(path) from None
    # root may ask every daemon; other users trust only processes of their own
    if not (os.geteuid() == 0 or may_command(peer_of(connection))):
        raise _ForeignError(path)


def _error_of(refused: Refused) -> MocapdError:
    kind = _BY_EXIT_CODE.get(refused.exit_code, UnavailableError)
    return kind(refused.what, refused.where, refused.fix)
