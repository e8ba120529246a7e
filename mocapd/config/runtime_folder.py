"""Where a running process tells others of its user how to reach it."""

import os
from pathlib import Path

SESSIONS = Path("/run/user")  # the runtime directories of sessions, by the user's id


def runtime_folder(state_dir: Path) -> Path:
    """$RUNTIME_DIRECTORY under systemd, else the session's runtime directory, else `state_dir`."""
    given = os.environ.get("RUNTIME_DIRECTORY", "").partition(":")[0]
    session = os.environ.get("XDG_RUNTIME_DIR", "")
    if given:
        return Path(given)
    return Path(session) / "mocapd" if session else state_dir


def folders_to_look_in(state_dir: Path, sessions: Path = SESSIONS) -> tuple[Path, ...]:
    """Where a process of our user may be told of: it may have been started in a session and asked for from outside of
    one, as by cron, or the other way round."""
    usual = runtime_folder(state_dir)
    of_session = sessions / str(os.geteuid()) / "mocapd"
    return (state_dir, of_session) if usual == state_dir else (usual, state_dir)
