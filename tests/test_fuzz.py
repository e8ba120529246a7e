"""A short run of the fuzzers: a hundredth of every row's inputs ends in values and named errors only."""

import os
import subprocess
import sys
from pathlib import Path

from tests.conftest import ROOT

_SCALE = "0.01"


def test_no_input_ends_in_an_unnamed_error(clean_env: dict[str, str], cache_home: Path) -> None:
    """In a process of its own, as `make fuzz` does: its rows are forked, which threads do not survive."""
    ran = subprocess.run(
        [
            sys.executable,
            "-m",
            "tests.fuzz",
            "--scale",
            _SCALE,
            "--jobs",
            "3",  # some of them wait more than they work
            "--cache",
            str(cache_home / "fuzz"),
        ],
        cwd=ROOT,
        env=clean_env | {"PATH": os.environ["PATH"]},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
