"""Simulated USB sockets: a file, editable at run time, says which webcam sits in which socket and its fault.

    {"webcams": {"cam0": "usb:1-1:046d:0825:A0", "cam1": "usb:1-2:046d:0825:B1"},
     "sockets": {"1-1": {"webcam": "cam0"}, "1-4": {"webcam": "cam1", "plugging": 7, "fault": "black"}}}

`webcams`: the identity of each, with the socket at its setup. `sockets`: what is plugged in now. Change `plugging` at
each plugging in, as the kernel assigns another node. docs/faults.md describes the use.
"""

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import msgspec

from mocapd.boundary.files import read_file
from mocapd.boundary.parsing import decode_json
from mocapd.capture.webcam.identity import WebcamIdentity, match_identity, parse_identity
from mocapd.errors import InputError, MalformedError, UnavailableError

_MOST_BYTES = 1 << 16


class Fault(StrEnum):
    """Faults of a plugged webcam."""

    NONE = ""
    FROZEN = "frozen"  # the same picture over and over
    BLACK = "black"
    TORN = "torn"  # every second picture comes cut
    SMALL = "small"  # pictures of half the size
    STALLED = "stalled"  # sends nothing; the driver says so after a second
    STUCK = "stuck"  # the driver does not come back at all


class Plugged(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of a socket."""

    webcam: str
    plugging: int = 0
    fault: Fault = Fault.NONE


class SocketsFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The whole file; see above."""

    webcams: dict[str, str]
    sockets: dict[str, Plugged]


@dataclass(frozen=True, slots=True)
class FoundSocket:
    """The location of a webcam: port path, content of the socket; moved: not the configured port."""

    port: str
    plugged: Plugged
    moved: bool


class Sockets:
    """The file as it is now; from any threads."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = threading.Lock()  # guards what follows
        self._cached: tuple[tuple[int, int, int], SocketsFile] | None = None
        self._taken: dict[Plugged, object] = {}

    def now(self) -> SocketsFile:
        """Raises InputError."""
        try:
            stat = self.path.stat()
        except OSError as error:
            raise InputError(f"cannot be read ({error.strerror})", str(self.path), _FIX) from None
        version = (stat.st_ino, stat.st_mtime_ns, stat.st_size)
        with self._lock:
            if self._cached is None or self._cached[0] != version:
                try:
                    file = decode_json(read_file(self.path, _MOST_BYTES), SocketsFile)
                except MalformedError as error:
                    raise InputError(f"no sockets: {error.what}", str(self.path), _FIX) from None
                self._cached = version, file
            return self._cached[1]

    def identity(self, webcam: str) -> WebcamIdentity:
        """The identity of a webcam, with the socket at its setup. Raises InputError or ConfigError."""
        webcams = self.now().webcams
        if webcam not in webcams:
            raise InputError(f"there is no webcam {webcam!r}", str(self.path), _FIX)
        return parse_identity(webcams[webcam])

    def find(self, webcam: str) -> FoundSocket:
        """Finds a webcam by its identity, as with real ones. Raises UnavailableError where it is absent or ambiguous,
        InputError or ConfigError for an invalid file."""
        file, wanted = self.now(), self.identity(webcam)
        identities = {name: parse_identity(text) for name, text in file.webcams.items()}
        present = {
            _present(identities, plugged.webcam, port): port
            for port, plugged in file.sockets.items()
        }
        others = tuple(identity for name, identity in identities.items() if name != webcam)
        match = match_identity(wanted, tuple(present), others)
        port = present[match.identity]
        return FoundSocket(port, file.sockets[port], match.moved)

    def take(self, plugged: Plugged, user: object) -> None:
        """Starts streaming. Raises UnavailableError while another user streams."""
        with self._lock:
            if self._taken.get(plugged, user) is not user:
                raise UnavailableError("busy: used already by this process", plugged.webcam, _FIX)
            self._taken[plugged] = user

    def give_back(self, plugged: Plugged, user: object) -> None:
        """Stops streaming; no effect for another user."""
        with self._lock:
            if self._taken.get(plugged) is user:
                del self._taken[plugged]


_FIX = "see docs/faults.md"


def _present(identities: Mapping[str, WebcamIdentity], webcam: str, port: str) -> WebcamIdentity:
    if webcam not in identities:
        raise InputError(f"socket {port} holds {webcam!r}, which is none of its webcams", "", _FIX)
    return WebcamIdentity(port, *identities[webcam].model)
