"""A service manager's end of the notification socket."""

import socket
from pathlib import Path

PATIENCE_S = 600.0  # a busy machine compiles for minutes


class Manager:
    """Binds `address`, which is a path, or `@NAME` for an abstract socket."""

    def __init__(self, address: str | Path) -> None:
        self.address = str(address)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.settimeout(PATIENCE_S)
        bound = self.address
        self._socket.bind("\0" + bound[1:] if bound.startswith("@") else bound)
        self.told: list[dict[str, str]] = []

    def next(self) -> dict[str, str]:
        """The next message; waits for it."""
        text = self._socket.recv(1 << 16).decode()
        self.told.append(dict(line.split("=", 1) for line in text.splitlines()))
        return self.told[-1]

    def until(self, name: str, value: str | None = None) -> list[dict[str, str]]:
        """The messages from now on, up to the one that says this."""
        began = len(self.told)
        while True:
            found = self.next().get(name)
            if found is not None and value in (None, found):
                return self.told[began:]

    def waiting(self) -> list[dict[str, str]]:
        """What has come and was not looked at yet."""
        began = len(self.told)
        self._socket.setblocking(False)
        try:
            while True:
                self.next()
        except BlockingIOError:
            return self.told[began:]
        finally:
            self._socket.settimeout(PATIENCE_S)

    def close(self) -> None:
        self._socket.close()
