"""A port for a daemon under measurement."""

import socket


def free_port(kind: socket.SocketKind) -> int:
    """A currently free port of 127.0.0.1; SOCK_STREAM for TCP, SOCK_DGRAM for UDP."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
