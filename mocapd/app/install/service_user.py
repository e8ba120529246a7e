"""A command run as the service runs, with its user, groups, directories and view of the disk: so it finds the service."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import psutil

from mocapd.errors import PermissionDeniedError, UnavailableError, UsageError

_OF_CALLER = ("TERM", "NO_COLOR", "COLUMNS", "PATH")  # its terminal, and where root's tools are
# Of the service's own environment, which it may have changed since its start, no more than this: root's tools are started
# with it, and LD_PRELOAD= or PATH= of a service that was broken into would be obeyed by root.
_OF_SERVICE = re.compile(
    r"(MOCAPD|XDG|NUMBA|OPENCV|LC)_\w+|(RUNTIME|STATE|CACHE|CONFIGURATION|LOGS)_DIRECTORY|HOME|USER|LOGNAME|LANG"
)
_RIG = re.compile(r"[A-Za-z0-9_:\-][A-Za-z0-9_.:\-]{0,63}")
_ANSWER_S = 10.0


@dataclass(frozen=True, slots=True)
class Call:
    """A command line and its environment; of the tools root's own, wherever the service would look for them."""

    argv: tuple[str, ...]
    env: Mapping[str, str]


def unit_of(rig: str) -> str:
    """The service, or that of this rig. Raises UsageError."""
    if rig and not _RIG.fullmatch(rig):
        raise UsageError(f"{rig!r} is no rig's name", "--rig", "as in mocapd@NAME")
    return f"mocapd@{rig}.service" if rig else "mocapd.service"


def main_pid(unit: str) -> int:
    """Of the running service. Raises UnavailableError."""
    asked = ("systemctl", "show", "--property=MainPID", "--value", unit)
    try:
        told = subprocess.run(
            asked, capture_output=True, text=True, timeout=_ANSWER_S, check=False
        ).stdout.strip()
    except (OSError, subprocess.TimeoutExpired) as error:
        raise UnavailableError(
            f"systemctl does not answer ({error})", unit, "is this machine run by systemd?"
        ) from None
    if not told.isdigit() or told == "0":
        raise UnavailableError("it does not run", unit, f"`systemctl start {unit}`")
    return int(told)


def call_like(pid: int, words: Sequence[str], env: Mapping[str, str] | None = None) -> Call:
    """`mocapd WORDS` as that process runs; env: the caller's, ours when None. Raises UnavailableError when it is gone,
    or a tool is missing."""
    nsenter, setpriv = (_tool(name) for name in ("nsenter", "setpriv"))
    env = os.environ if env is None else env
    try:
        process = psutil.Process(pid)
        uid, gid, own = process.uids().effective, process.gids().effective, process.environ()
        status = Path(f"/proc/{pid}/status").read_text("utf-8").splitlines()
    except (psutil.Error, OSError):
        raise UnavailableError("it has just ended", f"process {pid}", "try again") from None
    (groups,) = (line.split()[1:] for line in status if line.startswith("Groups:"))
    argv = (
        *(nsenter, f"--target={pid}", "--mount", "--"),
        *(setpriv, f"--reuid={uid}", f"--regid={gid}"),
        f"--groups={','.join(groups)}" if groups else "--clear-groups",
        *("--", sys.executable, "-P", "-m", "mocapd.cli.main", *words),
    )
    kept = {name: env[name] for name in _OF_CALLER if name in env}
    own = {name: value for name, value in own.items() if _OF_SERVICE.fullmatch(name)}
    return Call(argv, own | kept)


def become(rig: str, words: Sequence[str]) -> NoReturn:
    """Go on as that. Raises PermissionDeniedError for anybody but root, UnavailableError."""
    unit = unit_of(rig)
    if os.geteuid() != 0:
        raise PermissionDeniedError(
            "only root may act as the service", "command line", "run it with sudo"
        )
    call = call_like(main_pid(unit), words)
    sys.stdout.flush()
    os.chdir("/")
    os.execve(call.argv[0], call.argv, call.env)


def _tool(name: str) -> str:
    """Where it is by our own PATH. Raises UnavailableError."""
    found = shutil.which(name)
    if found is None:
        raise UnavailableError("is not installed", name, "install util-linux")
    return str(Path(found).absolute())
