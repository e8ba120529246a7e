"""Games that come anew, each in a process of its own: are they served, and how soon?

    python -m tests.attacks.newcomers PORT COUNT EVERY_S WITHIN_S

forks them from one process, which is quick, and prints as JSON how long each took from its first
attempt to connect until it had found the daemon alive, received a frame and got the health; null
for one that had not within WITHIN_S.
"""

import json
import os
import select
import subprocess
import sys
import time

import zenoh

from mocapd.bus.zenoh_client_config import client_config
from mocapd.client import Client, Link
from mocapd.errors import UnavailableError
from tests.attacks.scenario import Found
from tests.conftest import ROOT

WITHIN_S = 3.0
FORKING_S = 20.0  # what all the rest may take on a busy machine


def times_s(
    port: int, count: int = 1, every_s: float = 1.0, within_s: float = WITHIN_S
) -> list[float | None]:
    """How long each of so many newcomers took until it had everything [s]; None: too long."""
    words = [sys.executable, "-m", "tests.attacks.newcomers"]
    words += [str(port), str(count), str(every_s), str(within_s)]
    done = subprocess.run(
        words,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=count * every_s + within_s + FORKING_S,
    )
    times: list[float | None] = json.loads(done.stdout)
    return times


def found(times: list[float | None]) -> Found:
    """The slowest of them; it holds when all were served."""
    in_time = [time_s for time_s in times if time_s is not None]
    slowest = f", the slowest after {max(in_time):.2f} s" if in_time else ""
    return Found(f"{len(in_time)} of {len(times)}{slowest}", len(in_time) == len(times))


def main() -> None:
    """See the module."""
    port, count = int(sys.argv[1]), int(sys.argv[2])
    every_s, within_s = float(sys.argv[3]), float(sys.argv[4])
    sent = []
    next_s = time.monotonic()
    for _ in range(count):
        time.sleep(max(0.0, next_s - time.monotonic()))
        next_s += every_s
        told, tells = os.pipe()
        process_id = os.fork()
        if process_id == 0:
            _come(f"tcp/127.0.0.1:{port}", within_s, tells)
        os.close(tells)
        sent.append((process_id, told, time.monotonic() + within_s))
    print(json.dumps([_result(*one) for one in sent]))


def _result(process_id: int, told: int, until_s: float) -> float | None:
    ready, _, _ = select.select([told], [], [], max(0.0, until_s - time.monotonic()) + 1.0)
    text = os.read(told, 64) if ready else b""
    os.kill(process_id, 9)
    os.waitpid(process_id, 0)
    return float(text) if text else None


def _come(endpoint: str, within_s: float, tells: int) -> None:
    """Never returns."""
    began_s = time.monotonic()
    if _has_everything(endpoint, within_s):
        took_s = time.monotonic() - began_s
        if took_s <= within_s:
            os.write(tells, str(took_s).encode())
    os._exit(0)


def _has_everything(endpoint: str, within_s: float) -> bool:
    try:
        game = Client(Link(endpoint, connect_timeout_s=within_s))
    except UnavailableError:
        return False
    if game.wait(within_s) is None:
        return False
    config = json.dumps(client_config(endpoint, timeout_s=within_s))
    session = zenoh.open(zenoh.Config.from_json5(config))
    return any(reply.ok for reply in session.get("mocapd/v1/*/health", timeout=within_s))


if __name__ == "__main__":
    main()
