"""Connections that never say anything."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial

from tests.attacks import newcomers
from tests.attacks.attacked import attacked
from tests.attacks.scenario import Found, Scenario

NEWCOMERS = 12
EVERY_S = 0.5


@contextmanager
def silent_connections(port: int, count: int) -> Iterator[None]:
    """So many connections to a port of this machine, which say nothing."""
    with ExitStack() as opened:
        for _ in range(count):
            opened.enter_context(socket.create_connection(("127.0.0.1", port)))
        yield


def attack(count: int) -> Found:
    """Newcomers beside so many silent connections, from their beginning until after their end."""
    with attacked() as daemon, silent_connections(daemon.port, count):
        return newcomers.found(newcomers.times_s(daemon.port, NEWCOMERS, EVERY_S))


SCENARIOS = {
    f"newcomers-{count}-silent": Scenario(
        f"all served in {newcomers.WITHIN_S:g} s", partial(attack, count)
    )
    for count in (110, 300)
}
