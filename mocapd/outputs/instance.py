"""The name of a daemon, as in every message and key of it."""

import re
import socket


def chunk(name: str) -> str:
    """A name as one chunk of a key: characters with a meaning in Zenoh (`/ * $ ? # @`) become `_`.

    Names of letters, digits, `_`, `.` and `-` stay as they are; an empty name becomes `_`.
    """
    return re.sub(r"[^\w.\-]", "_", name, flags=re.ASCII) or "_"


def instance_name(given: str = "") -> str:
    """The daemon's name: the given one, or else the machine's."""
    return chunk(given or socket.gethostname())
