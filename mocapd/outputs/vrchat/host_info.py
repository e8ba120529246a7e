"""Queries the HOST_INFO of an OSCQuery service: `GET /?HOST_INFO`. The server is untrusted: anyone can announce one.

VRChat answers `{"NAME": "VRChat-Client-5F3A21", "OSC_IP": "127.0.0.1", "OSC_PORT": 9000, "OSC_TRANSPORT": "UDP",
"EXTENSIONS": {...}}`. Its OSC_IP is ignored: programs announce 127.0.0.1 to a whole network
(vrchat-community/osc#169). The server's address is VRChat's. Sources: Vidvox/OSCQueryProposal, and
github.com/vrchat-community/osc/wiki/OSCQuery.
"""

import socket
import threading
from contextlib import closing, suppress
from http.client import HTTPConnection, HTTPException
from typing import Annotated

import msgspec
from msgspec import Meta

from mocapd.boundary.parsing import decode_json
from mocapd.errors import MalformedError, UnavailableError
from mocapd.outputs.http_answer import read_body

PREFIX = "VRChat-Client-"  # of VRChat's name in the network
ANSWER_S = 2.0  # timeout of the whole answer [s]
_LONGEST_ANSWER = 64 << 10  # [bytes]


class HostInfo(msgspec.Struct, frozen=True, rename="upper"):
    """osc_port: the port for OSC, at the service's address."""

    name: Annotated[str, Meta(max_length=200)]
    osc_port: Annotated[int, Meta(ge=1, le=65535)]
    osc_transport: Annotated[str, Meta(max_length=200)] = "UDP"


def parse_host_info(data: bytes) -> HostInfo:
    """Parse VRChat's answer. Raises MalformedError, also for another program's answer."""
    info = decode_json(data, HostInfo)
    if not info.name.startswith(PREFIX):
        raise MalformedError(f"{info.name[:40]!r} is no VRChat")
    if info.osc_transport != "UDP":
        raise MalformedError(f"it wants OSC by {info.osc_transport[:40]!r}, not by UDP")
    return info


def ask_host_info(address: str, port: int, timeout_s: float = ANSWER_S) -> HostInfo:
    """Query the service at a numeric address. Raises UnavailableError without a valid answer in time."""
    try:
        return parse_host_info(_get(address, port, timeout_s))
    except (OSError, HTTPException, MalformedError) as error:
        raise UnavailableError(
            f"no answer that would do: {str(error) or type(error).__name__}",
            f"http://{address}:{port}/?HOST_INFO",
            "give VRChat's address as vrchat.destination",
        ) from None


def _get(address: str, port: int, timeout_s: float) -> bytes:
    """Raises OSError, HTTPException or MalformedError. A redirection is no answer."""
    with closing(HTTPConnection(address, port, timeout=timeout_s)) as connection:
        connection.connect()
        line: socket.socket = connection.sock
        # a timeout for each read alone would let an answer take hours
        end = threading.Timer(timeout_s, _hang_up, (line,))
        end.daemon = True
        end.start()
        try:
            connection.request("GET", "/?HOST_INFO")
            answer = connection.getresponse()
            if answer.status != 200:
                raise MalformedError(f"HTTP status {answer.status}")
            data = read_body(answer, _LONGEST_ANSWER + 1)
        finally:
            end.cancel()
    if len(data) > _LONGEST_ANSWER:
        raise MalformedError(f"more than {_LONGEST_ANSWER} bytes")
    return data


def _hang_up(line: socket.socket) -> None:
    with suppress(OSError):
        line.shutdown(socket.SHUT_RDWR)
