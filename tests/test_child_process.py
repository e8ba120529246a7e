"""A child of ours is gone within five seconds of its parent's end, however the parent ends."""

import os
import pty
import re
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from mocapd.child_process import child_command
from tests.conftest import ROOT
from tests.outputs.frames import eventually
from tests.processes import still_runs

# one that ends in order, as the daemon does, and one whose every thread is kept busy
STAND_INS = {
    "orderly": "import time; print('up', flush=True); time.sleep(600)",
    "stuck": "print('up', flush=True); sum(iter(int, 1))",
}
PARENT = (
    "import subprocess, sys\n"
    "from mocapd.child_process import child_command\n"
    "child = subprocess.Popen(child_command(sys.argv[1]), stdout=subprocess.PIPE, text=True)\n"
    "child.stdout.readline()\n"
    "print(child.pid, flush=True)\n"
    "sys.stdin.readline()\n"
)


@pytest.mark.parametrize("stand_in", STAND_INS)
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_child_ends_with_a_parent_that_is_killed(number: signal.Signals, stand_in: str) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", PARENT, STAND_INS[stand_in]],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        assert psutil.pid_exists(child)
        parent.send_signal(number)
        parent.wait()
        assert eventually(lambda: not still_runs(child), 5.0)


def test_a_child_ends_with_the_terminal_of_its_parent() -> None:
    parent, terminal = pty.fork()
    if parent == 0:
        os.execv(sys.executable, [sys.executable, "-c", PARENT, STAND_INS["orderly"]])
    child = int(os.read(terminal, 100).split()[0])
    os.close(terminal)
    os.waitpid(parent, 0)
    assert eventually(lambda: not still_runs(child), 5.0)


def test_no_program_of_ours_starts_another_one_that_may_outlive_it() -> None:
    """But for `as-service`, which systemd runs."""
    starts = re.compile(r"\bsys\.executable, *\"-[cm]|\bsys\.executable, \"-P\"")
    sources = [*(ROOT / "mocapd").rglob("*.py"), *(ROOT / "clients").rglob("*.py")]
    found = {path.name for path in sources if starts.search(path.read_text())}
    assert found == {"child_process.py", "service_user.py"}


def test_a_child_that_asks_after_its_parents_end_ends_at_once(tmp_path: Path) -> None:
    command = child_command("open('began', 'w')")
    command[4] = str(os.getppid())  # not this process, which starts it
    assert subprocess.run(command, cwd=tmp_path, check=False).returncode == 1
    assert list(tmp_path.iterdir()) == []


def test_a_child_runs_nothing_of_the_folder_in_which_it_is_started(tmp_path: Path) -> None:
    (tmp_path / "msgspec.py").write_text("raise SystemExit('of the working directory')")
    done = subprocess.run(child_command("import msgspec"), cwd=tmp_path, check=False)
    assert done.returncode == 0
