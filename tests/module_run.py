"""Runs a module of the tests as `make` does: in a process of its own."""

import os
import subprocess
import sys

from tests.conftest import ROOT


def module_run(env: dict[str, str], module: str, *words: str) -> str:
    """What it prints; the test fails with all of it when something was not as it should be."""
    ran = subprocess.run(
        [sys.executable, "-m", module, *words],
        cwd=ROOT,
        env=env | {"PATH": os.environ["PATH"]},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout
