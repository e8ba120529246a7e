"""How a service ends when it is told to, from its first import on, also by its terminal being closed."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from tests.capture.films import write_film
from tests.cli.mocapd_process import COMMAND, start

WAIT_S = 600.0  # a busy machine compiles for long
QUIET = ("--tracker", "canned", "--set", "zenoh.enabled=false", "--set", "osc.enabled=false")


@pytest.fixture
def env(clean_env: dict[str, str], tmp_path: Path) -> dict[str, str]:
    """Of a user whose session has a runtime directory, and no desktop."""
    runtime = tmp_path / "runtime"
    runtime.mkdir(mode=0o700)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "RUNTIME_DIRECTORY"):
        clean_env.pop(name, None)
    return clean_env | {"XDG_RUNTIME_DIR": str(runtime), "XDG_STATE_HOME": str(tmp_path / "state")}


def wait_until(condition: Callable[[], bool]) -> None:
    until_s = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < until_s
        time.sleep(0.002)


def catches(pid: int, number: signal.Signals) -> bool:
    """Whether the process has a handler for this signal."""
    status = Path(f"/proc/{pid}/status").read_text()
    caught = int(status.partition("SigCgt:")[2].split()[0], 16)
    return bool(caught >> (number - 1) & 1)


def told_after(
    seconds: float, number: signal.Signals, env: dict[str, str], simulated: str
) -> tuple[int, str]:
    """Exit code and stderr of a daemon that is told so long after its first handler was in place."""
    words = ("run", "--capture", simulated, *QUIET)
    with start(env, *words) as process:
        try:
            wait_until(lambda: catches(process.pid, signal.SIGTERM))
            time.sleep(seconds)
            process.send_signal(number)
            _, err = process.communicate(timeout=WAIT_S)
        finally:
            process.kill()
        return process.returncode, err


@pytest.mark.parametrize(
    ("number", "code", "moments"), [(signal.SIGTERM, 0, 20), (signal.SIGINT, 130, 4)]
)
def test_it_ends_in_order_from_its_first_import_on(
    env: dict[str, str], simulated: str, number: signal.Signals, code: int, moments: int
) -> None:
    with ThreadPoolExecutor(2) as two:
        ends = two.map(
            lambda i: told_after(0.7 * i / moments, number, env, simulated), range(moments)
        )
    for ended, err in ends:
        assert ended == code, err
        assert "Traceback" not in err


def test_without_a_terminal_sighup_ends_nothing_from_its_first_import_on(
    env: dict[str, str], simulated: str
) -> None:
    words = ("run", "--capture", simulated, *QUIET)
    with start(env, *words) as process:
        wait_until(lambda: catches(process.pid, signal.SIGHUP))
        process.send_signal(signal.SIGHUP)  # nothing is read yet
        wait_until(lambda: bool(announced(env)))
        process.send_signal(signal.SIGHUP)
        assert process.stderr is not None
        while "taken up, within" not in (line := process.stderr.readline()):
            assert line, "it ended"
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=WAIT_S)
    assert process.returncode == 0
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("words", "number", "code"),
    [
        ("run", signal.SIGTERM, 0),
        ("calibrate --demo", signal.SIGHUP, 0),
        ("calibrate --demo", signal.SIGTERM, 0),
        ("calibrate --from-folder boards", signal.SIGTERM, -signal.SIGTERM),  # it is not done
        ("track capture", signal.SIGTERM, -signal.SIGTERM),
        ("track capture", signal.SIGINT, 130),
    ],
)
def test_who_ends_with_what_while_it_is_imported(words: str, number: int, code: int) -> None:
    program = (
        "import os, sys, time\n"
        "from mocapd.app.daemon.early_signals import end_at_once\n"
        "end_at_once(['mocapd', *sys.argv[2:]])\n"
        "os.kill(os.getpid(), int(sys.argv[1]))\n"
        "time.sleep(10)\n"
    )
    command = [sys.executable, "-c", program, str(int(number)), *words.split()]
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stderr) == (code, "")


def test_a_sigterm_while_the_interpreter_ends_changes_nothing(
    env: dict[str, str], tmp_path: Path
) -> None:
    """As of a service manager that tells it to end when its recordings have ended just before."""
    program = (
        "import os, signal, sys\n"
        "from mocapd.cli.main import main\n"
        "class Last:\n"
        "    def __del__(self, kill=os.kill, pid=os.getpid(), number=signal.SIGTERM):\n"
        "        kill(pid, number)\n"
        "last = Last()\n"
        "main()\n"
    )
    film = write_film(tmp_path / "a.avi", 5)
    command = [sys.executable, "-c", program, "run", f"--camera=a={film}", *QUIET]
    done = subprocess.run(
        command, env=env, capture_output=True, text=True, timeout=WAIT_S, check=False
    )
    assert done.returncode == 0, done.stderr


# Makes its stdin the terminal that it is controlled by.
IN_A_TERMINAL = """
import fcntl, os, sys, termios
os.setsid()
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.argv[1], sys.argv[1:])
"""


def announced(env: dict[str, str]) -> list[Path]:
    """The files that tell where pages are."""
    return list(Path(env["XDG_RUNTIME_DIR"]).rglob("*.json"))


@pytest.mark.parametrize("command", ["run", "calibrate"])
def test_a_terminal_that_is_closed_ends_it_in_order(
    env: dict[str, str], tmp_path: Path, command: str
) -> None:
    film = write_film(tmp_path / "a.avi", 1800)  # a minute
    words = [f"--camera=a={film}", *(QUIET if command == "run" else ["--no-browser"])]
    terminal, inside = os.openpty()
    os.set_blocking(terminal, False)
    process = subprocess.Popen(
        [sys.executable, "-c", IN_A_TERMINAL, *COMMAND, command, *words],
        env=env,
        stdin=inside,
        stdout=inside,
        stderr=inside,
    )
    os.close(inside)
    try:
        said = b""
        while not announced(env):
            with suppress(BlockingIOError):
                said += os.read(terminal, 10_000)  # else it waits for whoever reads
            assert process.poll() is None, said
            assert len(said) < 1_000_000
            time.sleep(0.01)
        os.close(terminal)
        assert process.wait(WAIT_S) == 0
        assert not announced(env)
    finally:
        process.kill()
        process.wait()
