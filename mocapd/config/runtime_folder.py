"""The folder in which a process announces itself to other processes of its user."""

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
    """Folders that may announce a process of our user: server and client may run inside or outside of a session, as under
    cron."""
    usual = runtime_folder(state_dir)
    of_session = sessions / str(os.geteuid()) / "mocapd"
    return (state_dir, of_session) if usual == state_dir else (usual, state_dir)
