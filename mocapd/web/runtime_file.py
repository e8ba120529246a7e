"""Where a running daemon says the URL of its page, so that `mocapd calibrate` finds it.

A webcam opens only once: whoever wants its pictures must ask the process that has it.
"""

import os
import urllib.error
import urllib.request
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit, urlunsplit

import msgspec

from mocapd.errors import CannotCreateError, UnavailableError
from mocapd.web.status import SetupAnswer, SetupRequest, Status
from mocapd.whole_file import whole_file

NAME = "page.json"
ANSWER_S = 2.0  # how long a living daemon may take to answer [s]
BEGIN_S = 20.0  # and to begin a setup: on a busy machine its code alone takes seconds to load [s]
BEGIN_S = 30.0  # and to begin a setup: cameras may have to be let go first [s]


class _Said(msgspec.Struct, frozen=True):
    url: str
    pid: int


@dataclass(frozen=True, slots=True)
class Running:
    """A page that answers. url: with its token; status: what it says of itself."""

    url: str
    status: Status


def runtime_path(state_dir: Path) -> Path:
    """$RUNTIME_DIRECTORY under systemd, else the session's runtime directory, else `state_dir`."""
    given = os.environ.get("RUNTIME_DIRECTORY", "").partition(":")[0]
    session = os.environ.get("XDG_RUNTIME_DIR", "")
    if given:
        return Path(given) / NAME
    return (Path(session) / "mocapd" if session else state_dir) / NAME


def announce(path: Path, url: str) -> None:
    """Say that our page is at `url`; only our user may read it, as it holds the token.

    Raises CannotCreateError.
    """
    said = msgspec.json.encode(_Said(url, os.getpid()))
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(path) as partial:
            made = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(made, "wb") as file:
                file.write(said)
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written: {error.strerror}",
            str(path),
            "set XDG_RUNTIME_DIR to your own folder",
        ) from error


def withdraw(path: Path) -> None:
    """Our page is gone. What another process has said there meanwhile stays."""
    said = _read(path)
    if said is not None and said.pid == os.getpid():
        path.unlink(missing_ok=True)


def running(path: Path) -> Running | None:
    """The page that is announced there, when it answers; None without one."""
    said = _read(path)
    if said is None:
        return None
    try:
        status = msgspec.json.decode(_answer(said.url, "/status", ANSWER_S), type=Status)
    except (OSError, msgspec.DecodeError):
        return None  # it ended without a word, and something else may have its port
    return Running(said.url, status)


def begin_setup(url: str, step: str | None) -> None:
    """Have that page begin a setup, or show `step` of the one it has. Raises UnavailableError."""
    try:
        _answer(url, "/setup", BEGIN_S, msgspec.json.encode(SetupRequest(step)))
    except urllib.error.HTTPError as refused:
        try:
            why = msgspec.json.decode(refused.read(), type=SetupAnswer)
        except msgspec.DecodeError:
            why = SetupAnswer(f"it refuses: {refused.reason}")
        raise UnavailableError(why.what, why.where, why.fix) from refused
    except OSError as error:
        raise UnavailableError(
            f"no answer: {error}", "the running daemon", "start it anew, or end it"
        ) from error


def _answer(url: str, path: str, timeout_s: float, body: bytes | None = None) -> bytes:
    """Raises OSError, of which urllib's errors are."""
    there = urlunsplit(urlsplit(url)._replace(path=path, fragment=""))
    # a proxy for the rest of the world is none for this machine
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(there, body, timeout=timeout_s) as answer:
        data: bytes = answer.read()
    return data


def _read(path: Path) -> _Said | None:
    try:
        return msgspec.json.decode(path.read_bytes(), type=_Said)
    except (OSError, msgspec.DecodeError):
        return None
