"""A port for a daemon under measurement."""

import socket


def free_port(kind: socket.SocketKind) -> int:
    """One of 127.0.0.1 that nobody has at this moment; SOCK_STREAM for TCP, SOCK_DGRAM for UDP."""
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])
