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

from mocapd.errors import ConfigError, PermissionDeniedError, UnavailableError

_OF_CALLER = (
    "TERM",
    "NO_COLOR",
    "COLUMNS",
)  # a terminal is the caller's, all else is the service's
_RIG = re.compile(r"[A-Za-z0-9_:\-][A-Za-z0-9_.:\-]{0,63}")
_ANSWER_S = 10.0
_TOOLS = ("nsenter", "setpriv")  # of util-linux, as every machine has it


@dataclass(frozen=True, slots=True)
class Call:
    """A command line and its environment."""

    argv: tuple[str, ...]
    env: Mapping[str, str]


def unit_of(rig: str) -> str:
    """The service, or that of this rig. Raises ConfigError."""
    if rig and not _RIG.fullmatch(rig):
        raise ConfigError(f"{rig!r} is no rig's name", "--rig", "as in mocapd@NAME")
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
    """`mocapd WORDS` as that process runs; env: the caller's, ours when None. Raises UnavailableError when it is gone."""
    env = os.environ if env is None else env
    try:
        process = psutil.Process(pid)
        uid, gid, own = process.uids().effective, process.gids().effective, process.environ()
        status = Path(f"/proc/{pid}/status").read_text("utf-8").splitlines()
    except (psutil.Error, OSError):
        raise UnavailableError("it has just ended", f"process {pid}", "try again") from None
    (groups,) = (line.split()[1:] for line in status if line.startswith("Groups:"))
    argv = (
        *("nsenter", f"--target={pid}", "--mount", "--"),
        *("setpriv", f"--reuid={uid}", f"--regid={gid}"),
        f"--groups={','.join(groups)}" if groups else "--clear-groups",
        *("--", sys.executable, "-P", "-m", "mocapd.cli.main", *words),
    )
    kept = {name: env[name] for name in _OF_CALLER if name in env}
    dropped = ("NOTIFY_SOCKET", "WATCHDOG_", "JOURNAL_STREAM", "INVOCATION_ID")
    own = {name: value for name, value in own.items() if not name.startswith(dropped)}
    return Call(argv, own | kept)


def become(rig: str, words: Sequence[str]) -> NoReturn:
    """Go on as that. Raises PermissionDeniedError for anybody but root, UnavailableError, ConfigError."""
    unit = unit_of(rig)
    if os.geteuid() != 0:
        raise PermissionDeniedError(
            "only root may act as the service", "command line", "run it with sudo"
        )
    for tool in _TOOLS:
        if shutil.which(tool) is None:
            raise UnavailableError("is not installed", tool, "install util-linux")
    call = call_like(main_pid(unit), words)
    sys.stdout.flush()
    os.chdir("/")
    os.execvpe(call.argv[0], call.argv, call.env)
