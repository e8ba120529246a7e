"""Many programs on the daemon's Zenoh port, each in a process of its own.

    python -m tests.attacks.herd PORT COUNT KIND LEASE_MS

forks them from one process, which is quick, prints their process ids as JSON once each of them has
received a frame, and kills them when its stdin ends. KIND: `reads` what comes, or is `stuck` in the
callback of its first frame. LEASE_MS: how long after its last sign of life the daemon misses one.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import zenoh

from mocapd.bus.zenoh_client_config import client_config
from tests.conftest import ROOT

LEASE_MS = 10_000  # Zenoh's own
FOREVER_S = 3600.0


class Herd:
    """Programs that receive frames."""

    def __init__(self, process_ids: tuple[int, ...]) -> None:
        self._process_ids = process_ids

    def freeze(self) -> None:
        """Stop them all, as a debugger does: they neither read nor leave."""
        for process_id in self._process_ids:
            os.kill(process_id, signal.SIGSTOP)


@contextmanager
def herd(port: int, count: int, kind: str = "reads", lease_ms: int = LEASE_MS) -> Iterator[Herd]:
    """So many programs that have received a frame; killed in the end."""
    words = [sys.executable, "-m", "tests.attacks.herd"]
    words += [str(port), str(count), kind, str(lease_ms)]
    with subprocess.Popen(
        words, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            yield Herd(tuple(json.loads(process.stdout.readline())))
        finally:
            process.stdin.close()


def main() -> None:
    """See the module."""
    port, count, kind, lease_ms = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    process_ids = []
    try:
        for _ in range(count):
            heard, hears = os.pipe()
            process_id = os.fork()
            if process_id == 0:
                _subscribe(port, kind, lease_ms, hears)
            os.close(hears)
            process_ids.append(process_id)
            os.read(heard, 1)
            os.close(heard)
        print(json.dumps(process_ids), flush=True)
        sys.stdin.read()
    finally:
        for process_id in process_ids:
            os.kill(process_id, signal.SIGKILL)
            os.waitpid(process_id, 0)


def _subscribe(port: int, kind: str, lease_ms: int, hears: int) -> None:
    """Never returns."""
    config = client_config(f"tcp/127.0.0.1:{port}", timeout_s=5.0)
    config["transport"]["link"]["tx"] = {"lease": lease_ms}
    heard_one = False

    def heard(_: zenoh.Sample) -> None:
        nonlocal heard_one
        if not heard_one:
            heard_one = True
            os.write(hears, b"1")
        if kind == "stuck":
            time.sleep(FOREVER_S)

    session = zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
    handler = zenoh.handlers.Callback(heard, indirect=False)
    session.declare_subscriber("mocapd/**", handler)
    time.sleep(FOREVER_S)
    os._exit(0)


if __name__ == "__main__":
    main()
