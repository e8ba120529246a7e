"""Keeps a process off the network: what was not opened for it here cannot be reached, as without a cable."""

import errno
import sys

own_ports: set[int] = set()  # of this machine, that inputs may connect to
_LOOPBACK = ("127.0.0.1", "::1", "localhost")


def keep_off() -> None:
    """From now on connecting, and looking up names, raises OSError, but for `own_ports`."""
    sys.addaudithook(_watch)


def _watch(event: str, args: tuple[object, ...]) -> None:
    if event == "socket.getaddrinfo":
        host, port = args[0], args[1]
    elif event == "socket.connect" and isinstance(args[1], tuple):
        host, port = args[1][:2]
    else:
        return
    if host not in _LOOPBACK or port not in own_ports:
        raise OSError(errno.ENETUNREACH, "the fuzzers stay on this machine")
