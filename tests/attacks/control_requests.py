"""The control socket under programs of the same user that ask without end, say nothing, or say too much."""

import os
import random
import socket
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path

from mocapd.control.control_client import RunningDaemon, running_daemons
from mocapd.control.control_socket import LONGEST_REQUEST, MOST_AT_ONCE
from mocapd.control.socket_place import short_address
from tests.attacks.attacked import Attacked, attacked
from tests.attacks.scenario import Found, Scenario

HERD_S = 20.0
ASKING, SHOUTING, SILENT = 8, 4, 4 * MOST_AT_ONCE
LEAST_HZ = 25.0
ALLOWED_MIB = 10.0
ALLOWED_DESCRIPTORS = 5
SETTLED_S = 4.0  # longer than a request may take to come


def attack() -> Found:
    """What the daemon says of itself meanwhile and after, and what it has grown by."""
    with attacked() as daemon:
        there = _daemon(daemon)
        before_mib, before = daemon.resident_mib(), _descriptors(daemon)
        ending = threading.Event()
        herd = [
            threading.Thread(target=_again_and_again, args=(ending, do))
            for do in (
                *[lambda: _ask(there.path)] * ASKING,
                *[lambda: _shout(there.path)] * SHOUTING,
                lambda: _be_silent(there.path, ending),
            )
        ]
        for one in herd:
            one.start()
        time.sleep(HERD_S)
        ending.set()
        for one in herd:
            one.join()
        time.sleep(SETTLED_S)
        after = _daemon(daemon).status
        more_mib = daemon.resident_mib() - before_mib
        more = _descriptors(daemon) - before
    figure = f"{after.rate_hz:.1f} Hz, {more_mib:.1f} MiB and {more} descriptors more"
    holds = after.rate_hz >= LEAST_HZ and more_mib <= ALLOWED_MIB and more <= ALLOWED_DESCRIPTORS
    return Found(figure, holds)


def _daemon(daemon: Attacked) -> RunningDaemon:
    """As commands find it: as soon as it runs."""
    until_s = time.monotonic() + 60.0
    while time.monotonic() < until_s:
        found = running_daemons((daemon.log.parent / "mocapd",), services=()).daemons
        if found:
            return found[0]
        time.sleep(0.2)
    raise RuntimeError(f"the daemon has no control socket:\n{daemon.log.read_text()}")


def _descriptors(daemon: Attacked) -> int:
    return len([*Path(f"/proc/{daemon.process.pid}/fd").iterdir()])


def _again_and_again(ending: threading.Event, do: Callable[[], None]) -> None:
    while not ending.is_set():
        with suppress(OSError):
            do()


def _connected(path: Path) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX)
    with short_address(path) as address:
        connection.settimeout(5.0)
        connection.connect(address)
    return connection


def _ask(path: Path) -> None:
    with _connected(path) as connection:
        connection.sendall(b'{"verb": "status"}\n')
        if random.random() < 0.5:  # the others leave without their answer
            connection.recv(1 << 16)


def _shout(path: Path) -> None:
    with _connected(path) as connection:
        connection.sendall(os.urandom(random.randrange(2 * LONGEST_REQUEST)) + b"\n")
        connection.recv(1 << 16)


def _be_silent(path: Path, ending: threading.Event) -> None:
    with ExitStack() as opened:
        for _ in range(SILENT):
            opened.enter_context(_connected(path))
        ending.wait(1.0)


SCENARIOS = {
    "control": Scenario(
        f"at least {LEAST_HZ:g} Hz, {ALLOWED_MIB:g} MiB and {ALLOWED_DESCRIPTORS} descriptors more at most",
        attack,
    )
}
