"""Runs the command line as a user does: in a process of its own, in the environment of the test."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

COMMAND = (sys.executable, "-m", "mocapd.cli.main")


@dataclass(frozen=True)
class Outcome:
    """How a command ended."""

    code: int
    out: str
    err: str


def mocapd(env: dict[str, str], *words: str | Path, cwd: Path | None = None) -> Outcome:
    """Run one command to its end."""
    done = subprocess.run(
        [*COMMAND, *map(str, words)],
        env=env,
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


def start(env: dict[str, str], *words: str | Path) -> subprocess.Popen[str]:
    """Start one command, without a terminal; whoever starts it ends it."""
    return subprocess.Popen(
        [*COMMAND, *map(str, words)],
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
