"""Plugs simulated webcams in and out, as a person would: by the control file that ships."""

from collections.abc import Mapping
from pathlib import Path

import msgspec

from mocapd.capture.simulated.sockets import Fault, Plugged, SocketsFile
from mocapd.whole_file import whole_file


class SocketControl:
    """Writes the file of the sockets. `sockets`: what is where now, by port."""

    def __init__(self, path: Path, webcams: Mapping[str, str], plugged: bool = True) -> None:
        """webcams: their identities by name; plugged: each is in its own port at first."""
        self.path, self.webcams = path, dict(webcams)
        self.sockets: dict[str, Plugged] = {}
        self._pluggings = 0
        self._write()
        if plugged:
            for name in webcams:
                self.plug(name)

    def port_of(self, webcam: str) -> str:
        """The port that it was set up in."""
        return self.webcams[webcam].split(":")[1]

    def plug(self, webcam: str, port: str | None = None, fault: Fault = Fault.NONE) -> None:
        """Into its own port, or another one."""
        self._pluggings += 1
        self.sockets[port or self.port_of(webcam)] = Plugged(webcam, self._pluggings, fault)
        self._write()

    def unplug(self, webcam: str) -> None:
        """From wherever it is."""
        self.sockets = {port: one for port, one in self.sockets.items() if one.webcam != webcam}
        self._write()

    def ail(self, webcam: str, fault: Fault) -> None:
        """It stays plugged in, and has this fault from now on."""
        for port, one in self.sockets.items():
            if one.webcam == webcam:
                self.sockets[port] = Plugged(webcam, one.plugging, fault)
        self._write()

    def _write(self) -> None:
        data = msgspec.json.encode(SocketsFile(self.webcams, self.sockets))
        with whole_file(self.path) as partial:
            partial.write_bytes(data)
