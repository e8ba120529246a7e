"""Identity of a webcam: USB port path and vid:pid:serial, never the /dev number.

/dev/videoN changes with the order of plugging, and identical webcams share one by-id link. The
port path (`1-3.2`: bus 1, socket 3, hub socket 2; as in sysfs) tells
twins apart; vid:pid:serial tells a camera that was moved to another socket.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from mocapd.errors import AmbiguousCameraError, ConfigError, UnavailableError

PREFIX = "usb:"
_PORT_PATH = re.compile(r"\d+-\d+(\.\d+)*")
_HEX4 = re.compile(r"[0-9a-f]{4}")


@dataclass(frozen=True, slots=True)
class WebcamIdentity:
    """`port_path` as in sysfs; `vid`, `pid` four hex digits; `serial` empty when the camera has none."""

    port_path: str
    vid: str
    pid: str
    serial: str = ""

    def __str__(self) -> str:
        """The form that goes into a configuration, such as `usb:1-3:046d:0825:5F2A11B0`."""
        return f"{PREFIX}{self.port_path}:{self.vid}:{self.pid}:{self.serial}"

    @property
    def model(self) -> tuple[str, str, str]:
        """The part independent of the socket: vid, pid, serial."""
        return (self.vid, self.pid, self.serial)


def parse_identity(text: str) -> WebcamIdentity:
    """The identity written as `usb:PORT:VID:PID:SERIAL`; SERIAL may be empty, and may hold colons.

    Raises ConfigError naming the part that is wrong.
    """
    fix = "write usb:PORT:VID:PID:SERIAL as `mocapd cameras` prints it, e.g. usb:1-3:046d:0825:"
    parts = text.removeprefix(PREFIX).split(":", 3)
    if not text.startswith(PREFIX) or len(parts) < 3:
        raise ConfigError(f"{text!r} is not a webcam identity", "", fix)
    port_path, vid, pid = parts[0], parts[1].lower(), parts[2].lower()
    if not _PORT_PATH.fullmatch(port_path):
        raise ConfigError(f"{port_path!r} is not a USB port path such as 1-3.2", text, fix)
    for what, value in (("vendor", vid), ("product", pid)):
        if not _HEX4.fullmatch(value):
            raise ConfigError(f"{value!r} is not a {what} id of four hex digits", text, fix)
    return WebcamIdentity(port_path, vid, pid, parts[3] if len(parts) == 4 else "")


@dataclass(frozen=True, slots=True)
class Match:
    """Which of the webcams that are present was meant, and whether it sits in another socket now."""

    identity: WebcamIdentity
    moved: bool


def match_identity(
    wanted: WebcamIdentity,
    present: Sequence[WebcamIdentity],
    others: Sequence[WebcamIdentity] = (),
) -> Match:
    """Finds `wanted` among the webcams that are `present`.

    An equal model in the same socket matches. Otherwise a single webcam with the same vid:pid:serial matches as moved,
    unless another configured camera (`others`) owns it or a configured twin is absent: it may be that twin. Several
    candidates are an error, as guessing would swap two calibrations. Twins swapped in their own sockets are
    undetectable here: see service.identical_cameras.
    Raises UnavailableError when it is absent, AmbiguousCameraError when several candidates remain.
    """
    if wanted in present:
        return Match(wanted, moved=False)
    owned = set(others)
    moved = [webcam for webcam in present if webcam.model == wanted.model and webcam not in owned]
    away = [twin for twin in others if twin.model == wanted.model and twin not in present]
    if len(moved) > 1:
        ports = ", ".join(webcam.port_path for webcam in moved)
        raise AmbiguousCameraError(
            f"{len(moved)} webcams with the same vid:pid:serial are in other sockets ({ports})",
            str(wanted),
            f"plug it into port {wanted.port_path} again, or name the one meant in the config",
        )
    if moved and away:
        own = " and ".join(webcam.port_path for webcam in (wanted, *away))
        raise AmbiguousCameraError(
            f"the webcam in port {moved[0].port_path} may be this one or its twin: they have the same vid:pid:serial",
            str(wanted),
            f"plug each into its own port again ({own}), or name the new ports in the config",
        )
    if moved:
        return Match(moved[0], moved=True)
    raise UnavailableError(
        "this webcam is not plugged in", str(wanted), f"plug it in (port {wanted.port_path})"
    )
