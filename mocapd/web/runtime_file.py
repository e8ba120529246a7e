"""Announces a process's page in the runtime directory, so that `mocapd calibrate` finds it.

A webcam opens only once, so another program must get its pictures from the process that has it. Each process has its
own files in the runtime directory, named by its pid. They are valid only while that process lives, belongs to our user
and listens on that port: after a kill, another user's server may have the port.
"""

import os
import urllib.error
import urllib.request
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from http.client import HTTPException
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit, urlunsplit

import msgspec
from msgspec import Meta

from mocapd.boundary.files import is_folder, read_file
from mocapd.boundary.parsing import decode_json
from mocapd.errors import InputError, MalformedError, UnavailableError, creation_errors
from mocapd.outputs.http_answer import read_body
from mocapd.outputs.socket_owners import listens
from mocapd.web.access import TOKEN
from mocapd.web.status_page import SetupAnswer, SetupRequest, Status
from mocapd.whole_file import whole_file

ADDRESS = "127.0.0.1"
SCHEMA = 1  # of page-PID.json
SETUP = "#setup"  # the part of the page
ANSWER_S = 2.0  # timeout of a daemon's answer [s]
BEGIN_S = 30.0  # timeout of a setup's start, which may have to release cameras first [s]
_LONGEST_FILE = 64 << 10  # [bytes]
_LONGEST_ANSWER = 1 << 20  # [bytes]


@dataclass(frozen=True, slots=True)
class Place:
    """Where a page is announced. folder: see `config.runtime_folder`; state_dir, instance: distinguish the pages of one
    user; findable: whether other programs may attach to it."""

    folder: Path
    state_dir: Path
    instance: str = ""
    findable: bool = True


class _Said(msgspec.Struct, frozen=True):
    """The content of page-PID.json; a newer schema may have another meaning."""

    port: Annotated[int, Meta(ge=1, le=65535)]
    token: Annotated[str, Meta(pattern=r"^[A-Za-z0-9_-]{1,200}$")]
    pid: Annotated[int, Meta(ge=1, le=2**31)]
    state_dir: str
    instance: str
    schema: Annotated[int, Meta(ge=1)] = SCHEMA


@dataclass(frozen=True, slots=True)
class Running:
    """A page that answers. url: with its token; status: its answer; redirect: a file of our user that redirects a browser
    to it."""

    url: str
    status: Status
    pid: int
    state_dir: str
    instance: str
    redirect: Path


def url_of(port: int, token: str) -> str:
    """The page's URL with its token."""
    return f"http://{ADDRESS}:{port}/?{TOKEN}={token}"


def redirect_file(folder: Path, pid: int) -> Path:
    """The file that redirects a browser to that process's page: every user can read a token in a command line."""
    return folder / f"page-{pid}.html"


def announce(place: Place, port: int, token: str) -> None:
    """Announce our page in files for our user only, because they hold the token. Raises CannotCreateError."""
    redirect = redirect_file(place.folder, os.getpid())
    with creation_errors(place.folder, "set XDG_RUNTIME_DIR to your own folder"):
        place.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        _write(redirect, _redirect_to(url_of(port, token) + SETUP).encode())
        if place.findable:
            state_dir = str(place.state_dir.resolve())
            said = _Said(port, token, os.getpid(), state_dir, place.instance)
            _write(redirect.with_suffix(".json"), msgspec.json.encode(said))


def withdraw(folder: Path) -> None:
    """Remove the files of our page."""
    _remove(redirect_file(folder, os.getpid()))


def running(folder: Path) -> tuple[Running, ...]:
    """The announced pages that answer, by process id; removes files of ended processes. None in a folder that another
    user has closed to us."""
    pages = []
    for path in folder.glob("page-*.json") if is_folder(folder) else ():
        said = _valid_announcement(path)
        if said is None:
            _remove(path)
            continue
        if said.schema > SCHEMA:
            continue
        url = url_of(said.port, said.token)
        try:
            status = decode_json(_answer(url, "/status", ANSWER_S), Status)
        except (OSError, MalformedError):
            continue  # it is ending, or too busy
        redirect = path.with_suffix(".html")
        pages.append(Running(url, status, said.pid, said.state_dir, said.instance, redirect))
    return tuple(sorted(pages, key=lambda page: page.pid))


def begin_setup(url: str, step: str | None) -> None:
    """Start a setup on that page, or show `step` of its current one. Raises UnavailableError, with the page's reason for a
    refusal."""
    try:
        _answer(url, "/setup", BEGIN_S, msgspec.json.encode(SetupRequest(step)))
    except urllib.error.HTTPError as refused:
        try:
            why = decode_json(read_body(refused, _LONGEST_ANSWER), SetupAnswer)
        except (OSError, HTTPException, MalformedError):
            why = SetupAnswer(f"it refuses: {refused.reason}")
        raise UnavailableError(why.what, why.where, why.fix) from refused
    except OSError as error:
        raise UnavailableError(
            f"no answer: {error}", "the running daemon", "restart it, or end it"
        ) from error


def _answer(url: str, path: str, timeout_s: float, body: bytes | None = None) -> bytes:
    """Raises OSError; urllib's errors are subclasses."""
    there = urlunsplit(urlsplit(url)._replace(path=path, fragment=""))
    # without the user's proxy, which is for other hosts
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    try:
        with opener.open(there, body, timeout=timeout_s) as answer:
            return read_body(answer, _LONGEST_ANSWER)
    except HTTPException as error:
        raise ConnectionError(f"{type(error).__name__}: {error}") from error


def _valid_announcement(path: Path) -> _Said | None:
    """The content of a file of our live process; None for any other file."""
    try:
        said = decode_json(read_file(path, _LONGEST_FILE), _Said)
    except InputError:  # also a MalformedError
        return None
    own_name = path.name == redirect_file(path.parent, said.pid).with_suffix(".json").name
    return said if own_name and listens(said.pid, ADDRESS, said.port) else None


def _write(path: Path, data: bytes) -> None:
    with whole_file(path, private=True) as partial:
        partial.write_bytes(data)


def _remove(path: Path) -> None:
    """Remove both files of a process; errors are ignored, because stale files do no harm."""
    for suffix in (".json", ".html"):
        with suppress(OSError):
            path.with_suffix(suffix).unlink()


def _redirect_to(url: str) -> str:
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8">'
        '<meta name="referrer" content="no-referrer"><title>mocapd</title>'
        f'<meta http-equiv="refresh" content="0;url={escape(url)}">'
        f'<p><a href="{escape(url)}" rel="noreferrer">Open the page of mocapd</a></p></html>\n'
    )
