"""Runs a command in the service's context (user, groups, directories, mounts), so that it finds the service."""

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
# Allow-list of the service's environment variables. The service may change its environment, and root's tools run with
# it: a compromised service must not pass LD_PRELOAD or PATH.
_OF_SERVICE = re.compile(
    r"(MOCAPD|XDG|NUMBA|OPENCV|LC)_\w+|(RUNTIME|STATE|CACHE|CONFIGURATION|LOGS)_DIRECTORY|HOME|USER|LOGNAME|LANG"
)
_RIG = re.compile(r"[A-Za-z0-9_:\-][A-Za-z0-9_.:\-]{0,63}")
_ANSWER_S = 10.0


@dataclass(frozen=True, slots=True)
class Call:
    """A command line and its environment; the tools are found by root's PATH."""

    argv: tuple[str, ...]
    env: Mapping[str, str]


def unit_of(rig: str) -> str:
    """The unit of the service, or of this rig's. Raises UsageError."""
    if rig and not _RIG.fullmatch(rig):
        raise UsageError(f"{rig!r} is no rig's name", "--rig", "as in mocapd@NAME")
    return f"mocapd@{rig}.service" if rig else "mocapd.service"


def main_pid(unit: str) -> int:
    """The pid of the running service. Raises UnavailableError."""
    asked = ("systemctl", "show", "--property=MainPID", "--value", unit)
    try:
        pid = subprocess.run(
            asked, capture_output=True, text=True, timeout=_ANSWER_S, check=False
        ).stdout.strip()
    except (OSError, subprocess.TimeoutExpired) as error:
        raise UnavailableError(
            f"systemctl does not answer ({error})", unit, "is this machine run by systemd?"
        ) from None
    if not pid.isdigit() or pid == "0":
        raise UnavailableError("it does not run", unit, f"`systemctl start {unit}`")
    return int(pid)


def call_like(pid: int, words: Sequence[str], env: Mapping[str, str] | None = None) -> Call:
    """The call of `mocapd WORDS` in that process's context; env: the caller's, ours when None. Raises UnavailableError
    when the process has ended or a tool is missing."""
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
    callers = {name: env[name] for name in _OF_CALLER if name in env}
    own = {name: value for name, value in own.items() if _OF_SERVICE.fullmatch(name)}
    return Call(argv, own | callers)


def become(rig: str, words: Sequence[str]) -> NoReturn:
    """Replaces this process by the call. Raises PermissionDeniedError unless root, UnavailableError."""
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
    """A tool's path, by our PATH. Raises UnavailableError."""
    path = shutil.which(name)
    if path is None:
        raise UnavailableError("is not installed", name, "install util-linux")
    return str(Path(path).absolute())
