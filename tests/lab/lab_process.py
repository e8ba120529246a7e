"""Runs a command of the lab as we do: in a process of its own."""

import subprocess
import sys
from pathlib import Path

from tests.cli.mocapd_process import PATIENCE_S, Outcome


def lab(env: dict[str, str], command: str, *words: str | Path, cwd: Path | None = None) -> Outcome:
    """Run one command, such as `evaluation`, to its end."""
    done = subprocess.run(
        [sys.executable, "-m", f"lab.{command}", *map(str, words)],
        env=env,
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)
