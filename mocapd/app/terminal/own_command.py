"""The name by which this program is called from any terminal."""

import shutil
import sys
from pathlib import Path


def own_command() -> str:
    """`mocapd` if the shell finds this installation by it, else its path."""
    own, found = Path(sys.executable).parent / "mocapd", shutil.which("mocapd")
    # pipx and the Debian package put a link into the shell's path
    is_found = found is not None and own.exists() and Path(found).samefile(own)
    return "mocapd" if is_found else str(own)
