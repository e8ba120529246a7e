"""The command line that a message names: what a system service's user has to type differs from what others type."""

import os
from pathlib import PurePath

_SYSTEM, _RIGS = PurePath("/var/lib"), "mocapd-rigs"


def user_command(words: str, program: str = "mocapd") -> str:
    """`mocapd WORDS`; in a system service `sudo mocapd as-service WORDS`, for one of several rigs with its --rig."""
    state = PurePath(os.environ.get("STATE_DIRECTORY", "").partition(":")[0])  # set by systemd
    if _SYSTEM not in state.parents:
        return f"{program} {words}"
    rig = f" --rig {state.name}" if state.parent.name == _RIGS else ""
    return f"sudo {program} as-service{rig} {words}"
