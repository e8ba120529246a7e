"""Runs a module of the tests as `make` does: in a process of its own."""

import os
import subprocess
import sys

from tests.conftest import ROOT

PATIENCE_S = 600.0


def module_run(
    env: dict[str, str], module: str, *words: str, patience_s: float = PATIENCE_S
) -> str:
    """What it prints; the test fails with all of it when something was not as it should be."""
    ran = subprocess.run(
        [sys.executable, "-m", module, *words],
        cwd=ROOT,
        env=env | {"PATH": os.environ["PATH"]},
        capture_output=True,
        text=True,
        timeout=patience_s,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout
