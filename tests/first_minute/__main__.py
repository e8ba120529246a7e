"""The first minute: what a fresh clone takes from `make demo` to a tracked person, and later starts.

    python -m tests.first_minute [--port 47100] [--quota 0.5] [--environment .venv]

Clones this checkout as it is committed into an empty folder, with empty HOME and XDG folders, and prints a table: the
environment, the first published skeleton of a tracked person, everything compiled, a second start, a start after
one kernel has changed, and how far the progress that was told was from the truth. A fixed loop of numpy and one kernel's
compiling are timed before and after it, so that machines, and moments of one machine, compare. --quota: shares of one
processor that everything runs with, by systemd-run, as root.
"""

import argparse
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from mocapd.client import Client, Link
from mocapd.control.control_client import running_daemons
from mocapd.errors import MocapdError
from tests.conftest import ROOT

_PATIENCE_S = 900.0
_LOOK_S = 0.1
_LOOP = """\
import time, numpy as np
began = time.perf_counter()
a = np.random.default_rng(1).random((300, 300))
for _ in range(60):
    a = np.tanh(a @ a.T / 300.0)
numpy_s = time.perf_counter() - began
from numba import njit
@njit
def mean(x):
    total = np.zeros(3)
    for i in range(x.shape[0]):
        for j in range(3):
            total[j] += np.sqrt(abs(x[i, j])) if x[i, j] > 0.1 else x[i, j]
    return total
began = time.perf_counter()
mean(a)
print(f"numpy {numpy_s:.2f} s, one kernel {time.perf_counter() - began:.2f} s")
"""
# a kernel that few others call, and a change of its code that changes no result
_KERNEL, _CALL = "mocapd/shirt/segmentation/segmentation_kernels.py", "    h, w = "


@dataclass
class Start:
    """One start: seconds from its command on."""

    environment_s: float = float("nan")
    first_s: float = float("nan")
    prepared_s: float = float("nan")
    cpu_s: float = float("nan")
    told: list[tuple[float, float]] = field(
        default_factory=list
    )  # when [s], what was said to be left [s]


class Demo:
    """`make demo` of a clone in a home of its own."""

    def __init__(
        self, clone: Path, home: Path, port: int, quota: float | None, environment: Path | None
    ) -> None:
        self.clone, self.port, self._home = clone, port, home
        self._client: Client | None = None
        self._runtime = home / "run" / "mocapd"
        (home / "run").mkdir(mode=0o700)
        dropped = ("MOCAPD_", "XDG_", "NUMBA_", "PYTHON", "MAKE", "VIRTUAL_ENV")
        env = {k: v for k, v in os.environ.items() if not k.startswith(dropped)}
        self.env = env | {
            "HOME": str(home), "XDG_RUNTIME_DIR": str(home / "run"), "MOCAPD_ZENOH_PORT": str(port),
            "MOCAPD_WEB_PORT": str(port + 1),
        }  # fmt: skip
        limit = f"CPUQuota={100 * (quota or 0):.0f}%"
        before = ["systemd-run", "--quiet", "--scope", "-p", limit] if quota else []
        self._command = [*before, "make", "demo"]
        if environment is not None:
            self.env["PYTHONPATH"] = str(clone)
            self._command = [*before, str(environment.resolve() / "bin" / "mocapd"), "demo"]

    def start(self, prepares: bool) -> Start:
        """Until somebody is tracked and, where it `prepares`, everything is prepared; then it is ended."""
        began_s, seen = time.monotonic(), Start()
        marks, cpu_s = self._marks(), _children_cpu_s()
        process = subprocess.Popen(
            self._command, cwd=self.clone, env=self.env, start_new_session=True
        )
        try:
            while time.monotonic() - began_s < _PATIENCE_S and process.poll() is None:
                now_s = time.monotonic() - began_s
                if math.isnan(seen.environment_s) and (self.clone / ".venv" / "ready").exists():
                    seen.environment_s = now_s
                if math.isnan(seen.prepared_s) and self._marks() > marks:
                    seen.prepared_s = now_s
                self._hear(seen, now_s)
                if math.isnan(seen.first_s) and self._tracks():
                    seen.first_s = time.monotonic() - began_s
                is_prepared = not math.isnan(seen.prepared_s)
                if not math.isnan(seen.first_s) and (is_prepared or not prepares):
                    break
                time.sleep(_LOOK_S)
        finally:
            self._let_go()
            os.killpg(process.pid, signal.SIGINT)
            process.wait(30.0)
            seen.cpu_s = _children_cpu_s() - cpu_s
        return seen

    def _let_go(self) -> None:
        """Of the daemon that ends."""
        if self._client is not None:
            self._client.close()
            self._client = None

    def _marks(self) -> int:
        """How often something was prepared."""
        path = self._home / ".cache" / "mocapd" / "prepared"
        return len(path.read_text().split()) if path.exists() else 0

    def _hear(self, seen: Start, now_s: float) -> None:
        """How long `mocapd status` says that it still takes."""
        for daemon in running_daemons([self._runtime], ()).daemons:
            found = re.search(r"about (\d+) (s|minutes) left", daemon.status.preparing)
            if found is not None:
                seen.told.append((now_s, int(found[1]) * (1.0 if found[2] == "s" else 60.0)))

    def _tracks(self) -> bool:
        try:
            if self._client is None:
                self._client = Client(Link(f"tcp/127.0.0.1:{self.port}", connect_timeout_s=0.0))
            body = self._client.poll()
        except MocapdError:
            return False
        return body is not None and body.tracked


def _children_cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def progress_gap(told: list[tuple[float, float]], end_s: float) -> float:
    """The largest gap between the share that was told, by the time that was left, and the share of the time that had gone,
    after the first third."""
    gaps = [0.0]
    for when_s, left_s in told:
        gone_s, all_s = when_s - told[0][0], end_s - told[0][0]
        if all_s / 3.0 < gone_s < all_s:
            gaps.append(abs(gone_s / (gone_s + left_s) - gone_s / all_s))
    return max(gaps)


def loop_times() -> str:
    """What the fixed loop takes now."""
    return subprocess.run(
        [sys.executable, "-c", _LOOP], check=True, capture_output=True, text=True
    ).stdout.strip()


def change_a_kernel(clone: Path) -> None:
    """So that its code differs, and its results do not."""
    path = clone / _KERNEL
    text = path.read_text()
    assert _CALL in text
    path.write_text(text.replace(_CALL, "    _changed = 1\n" + _CALL, 1))


def main() -> int:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--port", type=int, default=47100)
    parser.add_argument("--quota", type=float, help="shares of one processor")
    parser.add_argument(
        "--environment", type=Path, help="a ready .venv, where installing is not measured"
    )
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        clone, home = Path(folder) / "mocapd", Path(folder) / "home"
        home.mkdir(mode=0o700)
        subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
        demo = Demo(clone, home, arguments.port, arguments.quota, arguments.environment)
        before = loop_times()
        first, second = demo.start(prepares=True), demo.start(prepares=False)
        change_a_kernel(clone)
        changed = demo.start(prepares=True)
        after = loop_times()
    gap = progress_gap(first.told, first.prepared_s)
    sys.stdout.write(
        "| what | measured |\n|---|---|\n"
        f"| environment | {first.environment_s:.1f} s |\n"
        f"| everything compiled | {first.prepared_s:.1f} s |\n"
        f"| processor time until then, of all processes | {first.cpu_s:.0f} s |\n"
        f"| `make demo` to the first tracked person | {first.first_s:.1f} s |\n"
        f"| second start | {second.first_s:.1f} s |\n"
        f"| start after a change of one kernel | {changed.first_s:.1f} s |\n"
        f"| progress: largest gap after the first third | {100 * gap:.0f} % |\n"
        f"| fixed loop before; after | {before}; {after} |\n"
    )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
