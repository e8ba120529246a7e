"""The control socket: whatever comes is answered with a line, and a command understands a line or says it does not."""

import socket
from random import Random

import msgspec

from mocapd.boundary.parsing import decode_json
from mocapd.control.control_messages import Answer, Reloaded, StatusReport, Verb
from mocapd.control.control_socket import LONGEST_REQUEST, ControlSocket
from mocapd.control.line import read_line
from mocapd.control.socket_place import short_address, socket_path
from mocapd.errors import MalformedError
from tests.control.reports import report
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.row import Attempt, DeadlyError, Place, WrongError

_GOOD = b'{"verb":"reload"}'
_NESTED = (
    b"[" * 3000,
    b'{"verb":' * 500,
    b"\0" * 100,
    b"\n\n\n",
    b"",
    b"x" * (LONGEST_REQUEST + 1),
)
_ANSWER_S = 60.0


def requests(place: Place) -> Attempt:
    """Lines to a daemon, which does nothing but what it was asked by a whole word."""
    deaths: list[BaseException] = []
    path = socket_path(place.folder, 1)
    ControlSocket(path, _answer, deaths.append).open()
    if _asked(place, _GOOD).refused is not None:
        raise WrongError("a good request is refused")

    def attempt(random: Random, number: int) -> bool:
        sent = random.choice((mistyped(random, _GOOD, JSON_VALUES), damaged(random, _GOOD)))
        if random.random() < 0.05:
            sent = random.choice(_NESTED)
        answer = _asked(place, sent)
        if deaths:
            raise DeadlyError(deaths[0])
        return answer.refused is None

    return attempt


def answers(place: Place) -> Attempt:
    """What a command is answered."""
    good = msgspec.json.encode(report())
    decode_json(good, StatusReport)

    def attempt(random: Random, number: int) -> bool:
        decode_json(mistyped(random, good, JSON_VALUES), StatusReport)
        return True

    return attempt


def _answer(verb: Verb) -> Reloaded:
    if verb not in ("status", "recenter", "reload"):
        raise WrongError(f"asked for {verb!r}")
    return Reloaded(0.1, ())


def _asked(place: Place, sent: bytes) -> Answer:
    with socket.socket(socket.AF_UNIX) as connection:
        with short_address(socket_path(place.folder, 1)) as address:
            connection.connect(address)
        connection.sendall(sent + b"\n")
        connection.shutdown(socket.SHUT_WR)
        try:
            return decode_json(read_line(connection, 1 << 16, _ANSWER_S), Answer)
        except (MalformedError, OSError) as error:
            raise WrongError(f"no answer: {error}") from error
