"""The daemon that is attacked: `mocapd run` on simulated cameras, with a port and a home of its own."""

import os
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil

from tests.attacks.newcomers import times_s
from tests.cli.mocapd_process import COMMAND
from tests.conftest import ROOT
from tests.outputs.frames import free_port

START_S = 300.0  # the first start ever compiles, and renders the film
END_S = 30.0
SIMULATED = ("--capture", "sim:living_room")


@dataclass(frozen=True)
class Attacked:
    """A running daemon: its process, its Zenoh port, and what it wrote to stderr so far."""

    process: subprocess.Popen[bytes]
    port: int
    log: Path

    def resident_mib(self) -> float:
        """How much memory it has now [MiB]."""
        return float(psutil.Process(self.process.pid).memory_info().rss) / 2**20

    def peak_mib(self) -> float:
        """The most memory it ever had [MiB]."""
        lines = Path(f"/proc/{self.process.pid}/status").read_text().splitlines()
        (peak,) = (line.split()[1] for line in lines if line.startswith("VmHWM"))
        return int(peak) / 1024

    def end(self) -> tuple[int, float]:
        """SIGTERM; its exit code, and how long that took [s]. Raises TimeoutExpired."""
        began_s = time.monotonic()
        self.process.terminate()
        code = self.process.wait(END_S)
        return code, time.monotonic() - began_s


@contextmanager
def attacked(*words: str, cameras: Sequence[str] = SIMULATED) -> Iterator[Attacked]:
    """A daemon that already serves; killed in the end. `words` are further ones of `mocapd run`; cameras: those that say
    where its cameras are."""
    port = free_port()
    given = ("--set", f"zenoh.port={port}", "--set", "web.enabled=false", *words)
    with daemon_process(*given, cameras=cameras) as (process, log):
        _wait_until_it_serves(process, port, log)
        yield Attacked(process, port, log)


@contextmanager
def daemon_process(
    *words: str, cameras: Sequence[str] = SIMULATED
) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """A daemon that begins, alone in its surroundings, and its log, in whose folder it keeps everything; killed in
    the end."""
    dropped = ("MOCAPD_", "XDG_STATE_HOME", "XDG_RUNTIME_DIR", "RUNTIME_DIRECTORY", "JOURNAL")
    env = {k: v for k, v in os.environ.items() if not k.startswith(dropped)}
    command = [
        *(*COMMAND, "run", *cameras, "--tracker", "canned"),
        *("--set", "osc.enabled=false", *words),
    ]
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "stderr"
        env |= {"XDG_STATE_HOME": folder, "XDG_RUNTIME_DIR": folder, "PYTHONPATH": str(ROOT)}
        with log.open("wb") as stderr:
            process = subprocess.Popen(
                command, env=env, cwd=folder, stdout=stderr, stderr=subprocess.STDOUT
            )
        try:
            yield process, log
        finally:
            process.kill()
            process.wait()


def _wait_until_it_serves(process: subprocess.Popen[bytes], port: int, log: Path) -> None:
    until_s = time.monotonic() + START_S
    while not _serves(port):
        if process.poll() is not None or time.monotonic() > until_s:
            raise RuntimeError(f"the daemon does not serve:\n{log.read_text()}")


def _serves(port: int) -> bool:
    try:
        return times_s(port, within_s=1.0) != [None]
    except subprocess.TimeoutExpired:  # the machine is busy with something else
        return False
