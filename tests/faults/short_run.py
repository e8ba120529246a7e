"""A short run of one fault: what half an hour of them shows, in seconds."""

import os
import subprocess
import sys

from tests.conftest import ROOT

SHARE = "0.025"


def short_run(name: str, env: dict[str, str], share: str = SHARE) -> str:
    """What a row prints; the test fails with it when something was not as it should be."""
    ran = subprocess.run(
        [sys.executable, "-m", "tests.faults", name, "--share", share],
        cwd=ROOT,
        env=env | {"PATH": os.environ["PATH"]},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout
