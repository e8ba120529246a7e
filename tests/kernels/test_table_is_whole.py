"""The table of a first start names every kernel that the tracker then uses."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from mocapd.kernels.kernel_table import read_table
from tests.conftest import ROOT

pytestmark = pytest.mark.kernels


def test_what_the_tracker_uses_is_in_the_table(clean_env: dict[str, str], tmp_path: Path) -> None:
    """Else a start compiles it in the daemon, uncounted: `python -m lab.kernel_seconds --write` makes the table anew."""
    tmp_path.chmod(0o700)
    command = [
        sys.executable,
        "-m",
        "lab.kernel_seconds",
        "--stage",
        "auto",
        "--cache",
        str(tmp_path),
    ]
    done = subprocess.run(command, cwd=ROOT, env=clean_env, check=True, stdout=subprocess.PIPE)
    used = json.loads(done.stdout)["used"]
    known = {json.dumps([f"{row.module}.{row.function}", list(row.codes)]) for row in read_table()}
    assert len(used) > 50
    assert not set(used) - known
