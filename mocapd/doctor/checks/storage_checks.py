"""Checks of folders (private, writable, free space) and of ports."""

import shlex
from collections.abc import Iterator, Sequence

from mocapd.control.control_messages import StatusReport
from mocapd.doctor.facts import FolderFacts, PortFacts
from mocapd.doctor.finding import Finding, bad, ok, warn

LITTLE_BYTES = 1 << 30  # a recording with pictures takes that in minutes
TOO_LITTLE_BYTES = 200 << 20  # compiled code and pose database
_SMALL_FILES_BYTES = 1 << 20


def check_folder(facts: FolderFacts) -> Finding:
    """Checks that the folder is writable, private and has free space."""
    about = f"folder {facts.key}"
    if facts.trouble is not None:
        return bad(about, f"{facts.path}: {facts.trouble.what}", facts.trouble.fix)
    quoted = shlex.quote(str(facts.path))
    least, usual = TOO_LITTLE_BYTES, LITTLE_BYTES
    if facts.holds_little:
        least = usual = _SMALL_FILES_BYTES
    if facts.free_bytes is not None and facts.free_bytes < least:
        return bad(about, f"{facts.path}: {_room(facts.free_bytes)}", f"make room: df -h {quoted}")
    if facts.open_to_others:
        return warn(about, f"{facts.path}: others may look into it", f"chmod 700 {quoted}")
    if facts.free_bytes is not None and facts.free_bytes < usual:
        return warn(about, f"{facts.path}: {_room(facts.free_bytes)}", f"make room: df -h {quoted}")
    room = "" if facts.free_bytes is None else f", {_room(facts.free_bytes)}"
    return ok(about, f"{facts.path}: private and writable{room}")


def check_ports(ports: Sequence[PortFacts], daemons: Sequence[StatusReport]) -> Iterator[Finding]:
    """Checks that the ports are free for a new daemon."""
    own = {str(daemon.pid) for daemon in daemons}
    for port in ports:
        about = f"port {port.port}"
        if not port.holder:
            yield ok(about, f"free for {port.key}")
        elif any(f"(pid {pid})" in port.holder for pid in own):
            yield ok(about, f"{port.key} of the running daemon")
        else:
            yield bad(
                about,
                f"{port.holder} has it, and {port.key} wants it",
                f"end that program, or set {port.key} to another",
            )


def _room(free_bytes: int) -> str:
    if free_bytes < 1 << 30:
        return f"{free_bytes / (1 << 20):.0f} MB free"
    return f"{free_bytes / (1 << 30):.0f} GB free"
