"""One line of bounded length from a socket, within a bounded time."""

import socket
import time

from mocapd.errors import MalformedError

_CHUNK = 1 << 16


def read_line(connection: socket.socket, most_bytes: int, within_s: float) -> bytes:
    """Reads a line without its end; drops what follows. Raises MalformedError, or OSError: TimeoutError after
    `within_s` [s], however slowly the bytes drip."""
    until_s = time.monotonic() + within_s
    data = bytearray()
    while b"\n" not in data:
        if len(data) > most_bytes:
            raise MalformedError(f"a line of more than {most_bytes} bytes")
        left_s = until_s - time.monotonic()
        if left_s <= 0.0:
            raise TimeoutError("timed out")
        connection.settimeout(left_s)
        part = connection.recv(_CHUNK)
        if not part:
            raise MalformedError("ends in the midst of its line")
        data += part
    return bytes(data.partition(b"\n")[0])
