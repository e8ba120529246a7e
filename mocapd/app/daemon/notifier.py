"""The service manager's notification socket, sd_notify(3): ready, state, reload, end, and signs of life.

Written here because no library fits: sdnotify has seen no release since 2017, and systemd-watchdog times by the wall
clock, which an NTP step moves; neither knows of reloads or of another time limit.
"""

import os
import socket
from collections.abc import MutableMapping
from contextlib import suppress

from mocapd.clock import monotonic_ns
from mocapd.errors import UnavailableError, one_line

_VARIABLES = ("NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID")
_SEND_S = 0.2  # a manager that takes nothing for so long is told the next time
_READY_S = 5.0  # but that we are ready it must hear
_PER_US = 1000  # ns
_LONGEST_LIMIT = 20  # digits: those of 64 bits
_FEEDS = 4  # signs of life within the time limit


class Notifier:
    """Used by one thread. Without a manager everything is said to nobody."""

    def __init__(self, address: str = "", watchdog_ns: int = 0) -> None:
        """address: of a datagram socket, `@` for an abstract one; watchdog_ns: the longest time without a sign of
        life, 0 for no limit. Raises UnavailableError."""
        self._watchdog_ns = watchdog_ns
        self._fed_ns = monotonic_ns()
        self._status = ""
        self._stops = False
        self._socket: socket.socket | None = None
        if address:
            self._socket = _connected(address)

    @classmethod
    def of_environment(cls, env: MutableMapping[str, str] | None = None) -> "Notifier":
        """Of the manager that started this process; its variables go, as they are not meant for children.
        Raises UnavailableError."""
        env = os.environ if env is None else env
        address, limit_us, pid = (env.pop(name, "") for name in _VARIABLES)
        meant = pid in ("", str(os.getpid()))
        is_limit = limit_us.isascii() and limit_us.isdigit() and len(limit_us) <= _LONGEST_LIMIT
        return cls(address, int(limit_us) * _PER_US if meant and is_limit else 0)

    def ready(self, status: str) -> None:
        """The outputs are open. Raises UnavailableError when nobody takes that."""
        # a camera may call itself anything, also in several lines, of which each would be a word of ours
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
        """A line for people; sent when it is another one."""
        text = one_line(text)
        if text != self._status and self._tell(f"STATUS={text}"):
            self._status = text

    def reloading(self) -> None:
        """The configuration is read again, until `reloaded`."""
        self._tell("RELOADING=1", f"MONOTONIC_USEC={monotonic_ns() // _PER_US}")

    def reloaded(self) -> None:
        """Well or not, that is over."""
        self._tell("READY=1")

    def stopping(self) -> None:
        """The end begins; said once."""
        if not self._stops:
            self._stops = True
            self._tell("STOPPING=1", "STATUS=stopping")

    def patience(self, patience_s: float) -> None:
        """Until `as_usual`, so long may pass without a sign of life."""
        if self._watchdog_ns:
            self._tell(
                f"WATCHDOG_USEC={max(round(patience_s * 1e6), self._watchdog_ns // _PER_US)}"
            )

    def as_usual(self) -> None:
        """From now on the time limit is again what the manager gave; this is a sign of life."""
        if self._watchdog_ns:
            self._tell(f"WATCHDOG_USEC={self._watchdog_ns // _PER_US}", "WATCHDOG=1")
            self._fed_ns = monotonic_ns()

    @property
    def wants_life(self) -> bool:
        """Whether a sign of life is due."""
        return 0 < self._watchdog_ns <= _FEEDS * (monotonic_ns() - self._fed_ns)

    def alive(self) -> None:
        """A sign of life."""
        if self._tell("WATCHDOG=1"):
            self._fed_ns = monotonic_ns()

    def close(self) -> None:
        """Nothing more is said."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _tell(self, *lines: str) -> bool:
        """Whether the manager took it; while it is busy or started anew it does not."""
        with suppress(OSError):
            self._send(*lines)
            return True
        return False

    def _send(self, *lines: str) -> None:
        if self._socket is not None:
            self._socket.send("\n".join(lines).encode())


def _connected(address: str) -> socket.socket:
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
