"""Which Debian mirror this machine is set up with: none is named in the project."""

import re
from pathlib import Path

APT = Path("/etc/apt")
_ARCHIVE = re.compile(r"\w+://\S+/debian/?")  # not debian-security, nor a mirror of something else


def configured_mirror(apt: Path = APT) -> str | None:
    """The address of Debian's archive in the machine's list of sources, of either format; None where there is none."""
    files = [apt / "sources.list", *sorted((apt / "sources.list.d").glob("*"))]
    for file in files:
        if file.suffix in (".list", ".sources") and file.is_file():
            for line in file.read_text(errors="replace").splitlines():
                if line.lower().startswith(("deb ", "uris:")):
                    found = next(filter(_ARCHIVE.fullmatch, line.split()), None)
                    if found:
                        return found
    return None
