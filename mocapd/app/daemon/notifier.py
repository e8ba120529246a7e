"""The service manager's notification socket, sd_notify(3): ready, status, reload, stop, and watchdog heartbeats.

Written here because no library fits: sdnotify has had no release since 2017, and systemd-watchdog times by the wall
clock, which an NTP step moves; neither knows of reloads or of another time limit.
"""

import os
import socket
from collections.abc import MutableMapping
from contextlib import suppress

from mocapd.clock import monotonic_ns
from mocapd.errors import UnavailableError, one_line

_VARIABLES = ("NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID")
_SEND_S = 0.2  # a message that the manager does not take so long is dropped
_READY_S = 5.0  # timeout of the message READY, which must arrive
_PER_US = 1000  # ns
_LONGEST_LIMIT = 20  # digits: those of 64 bits
_FEEDS = 4  # heartbeats within the time limit


class Notifier:
    """Not thread-safe. Without a manager every message is dropped."""

    def __init__(self, address: str = "", watchdog_ns: int = 0) -> None:
        """address: of a datagram socket, `@` for an abstract one; watchdog_ns: the watchdog's time limit,
        0 for none. Raises UnavailableError."""
        self._watchdog_ns = watchdog_ns
        self._fed_ns = monotonic_ns()
        self._status = ""
        self._stops = False
        self._socket: socket.socket | None = None
        if address:
            self._socket = _connect(address)

    @classmethod
    def of_environment(cls, env: MutableMapping[str, str] | None = None) -> "Notifier":
        """The notifier of the manager that started this process. Removes its variables, which children must not inherit.
        Raises UnavailableError."""
        env = os.environ if env is None else env
        address, limit_us, pid = (env.pop(name, "") for name in _VARIABLES)
        is_for_us = pid in ("", str(os.getpid()))
        is_limit = limit_us.isascii() and limit_us.isdigit() and len(limit_us) <= _LONGEST_LIMIT
        return cls(address, int(limit_us) * _PER_US if is_for_us and is_limit else 0)

    def ready(self, status: str) -> None:
        """Sends READY: the outputs are open. Raises UnavailableError when it is not taken."""
        # a camera's name may contain line breaks, which would forge messages
        self._status = status = one_line(status)
        if self._socket is None:
            return
        try:
            self._socket.settimeout(_READY_S)
            self._send("READY=1", f"STATUS={status}")
        except OSError as error:
            raise UnavailableError(
                f"does not take that mocapd is ready ({error.strerror or error})",
                "the service manager's NOTIFY_SOCKET",
                "start it by systemctl, or unset the variable",
            ) from None
        finally:
            self._socket.settimeout(_SEND_S)

    def status(self, text: str) -> None:
        """Sends a status line for users if it has changed."""
        text = one_line(text)
        if text != self._status and self._try_send(f"STATUS={text}"):
            self._status = text

    def reloading(self) -> None:
        """Sends RELOADING, until `end_reload`."""
        self._try_send("RELOADING=1", f"MONOTONIC_USEC={monotonic_ns() // _PER_US}")

    def end_reload(self) -> None:
        """Sends the end of a reload, successful or not."""
        self._try_send("READY=1")

    def stopping(self) -> None:
        """Sends STOPPING once."""
        if not self._stops:
            self._stops = True
            self._try_send("STOPPING=1", "STATUS=stopping")

    def extend_watchdog(self, limit_s: float) -> None:
        """Extends the watchdog's time limit to `limit_s` [s], until `restore_watchdog`."""
        if self._watchdog_ns:
            limit_us = max(round(limit_s * 1e6), self._watchdog_ns // _PER_US)
            self._try_send(f"WATCHDOG_USEC={limit_us}")

    def restore_watchdog(self) -> None:
        """Restores the manager's time limit, and sends a heartbeat."""
        if self._watchdog_ns:
            self._try_send(f"WATCHDOG_USEC={self._watchdog_ns // _PER_US}", "WATCHDOG=1")
            self._fed_ns = monotonic_ns()

    @property
    def is_heartbeat_due(self) -> bool:
        """True when the next heartbeat is due."""
        return 0 < self._watchdog_ns <= _FEEDS * (monotonic_ns() - self._fed_ns)

    def heartbeat(self) -> None:
        if self._try_send("WATCHDOG=1"):
            self._fed_ns = monotonic_ns()

    def close(self) -> None:
        """Closes the socket; later messages are dropped."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _try_send(self, *lines: str) -> bool:
        """True if the manager took it; a busy or restarting manager does not."""
        with suppress(OSError):
            self._send(*lines)
            return True
        return False

    def _send(self, *lines: str) -> None:
        if self._socket is not None:
            self._socket.send("\n".join(lines).encode())


def _connect(address: str) -> socket.socket:
    """Raises UnavailableError."""
    if address[0] not in "/@":
        raise UnavailableError(
            f"{address!r} is no Unix socket",
            "NOTIFY_SOCKET",
            "unset it, or start mocapd by systemctl",
        )
    opened = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
    opened.settimeout(_SEND_S)
    try:
        opened.connect("\0" + address[1:] if address[0] == "@" else address)
    except (OSError, ValueError) as error:  # ValueError: a NUL; too long a path is an OSError
        opened.close()
        raise UnavailableError(
            f"cannot be reached ({error})",
            "NOTIFY_SOCKET",
            "unset it, or start mocapd by systemctl",
        ) from None
    return opened
