"""Connections to the page that never say anything, without its token."""

import resource
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress

from tests.attacks.attacked_page import AttackedPage, attacked_page
from tests.attacks.scenario import Found, Scenario

WITHIN_S = 3.0
ATTACK_S = 20.0
MOST_CPU = 0.5  # of one core, more than before
MOST_LOG_KB = 100.0


@contextmanager
def silent_connections(port: int, count: int) -> Iterator[None]:
    """So many connections to a port of this machine, which say nothing."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, count + 200)), hard))
    with ExitStack() as opened:
        for _ in range(count):
            one = opened.enter_context(socket.socket())
            one.setblocking(False)  # one that must wait is not waited for
            with suppress(BlockingIOError):
                one.connect(("127.0.0.1", port))
        yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def cpu_share(page: AttackedPage, seconds: float) -> float:
    """Of one core, over so long [s]."""
    before_s, began_s = page.cpu_s(), time.monotonic()
    time.sleep(seconds)
    return (page.cpu_s() - before_s) / (time.monotonic() - began_s)


def newcomers(count: int) -> Found:
    """One newcomer after the other beside so many silent connections, which come anew as they end."""
    came = []
    with attacked_page() as page:
        until_s = time.monotonic() + ATTACK_S
        while time.monotonic() < until_s:
            with silent_connections(page.port, count):
                came += [page.answers(WITHIN_S) for _ in range(5)]
    in_time = [one for one in came if one is not None]
    slowest = f", the slowest after {max(in_time):.2f} s" if in_time else ""
    return Found(f"{len(in_time)} of {len(came)}{slowest}", len(in_time) == len(came))


def burden(count: int) -> Found:
    """What so many silent connections cost, and a newcomer beside them and after them."""
    with attacked_page() as page:
        idle = cpu_share(page, 5.0)
        log_kb = page.log.stat().st_size / 1e3
        with silent_connections(page.port, count):
            busy = cpu_share(page, ATTACK_S)
            beside_s = page.answers(WITHIN_S)
        after_s = page.answers(WITHIN_S)
        log_kb = page.log.stat().st_size / 1e3 - log_kb
    holds = busy - idle <= MOST_CPU and log_kb <= MOST_LOG_KB
    came = ", ".join("not" if one is None else f"{one:.2f} s" for one in (beside_s, after_s))
    return Found(
        f"CPU {100 * idle:.0f} -> {100 * busy:.0f} %, {log_kb:.1f} kB of log, newcomers {came}",
        holds and None not in (beside_s, after_s),
    )


SCENARIOS = {
    "page-newcomers-300-silent": Scenario(f"all served in {WITHIN_S:g} s", lambda: newcomers(300)),
    "page-1200-silent": Scenario(
        f"CPU <= +{100 * MOST_CPU:.0f} %, log <= {MOST_LOG_KB:.0f} kB, newcomers in {WITHIN_S:g} s",
        lambda: burden(1200),
    ),
}
