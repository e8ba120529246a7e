"""Signals of a daemon, whatever happens while it is set up."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress

import pytest

from mocapd.app.daemon.main_loop import Signals

NUMBERS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


@pytest.fixture(autouse=True)
def handlers() -> Iterator[None]:
    """Those of the tests, put back in the end."""
    before = [signal.getsignal(number) for number in NUMBERS]
    yield
    for number, handler in zip(NUMBERS, before, strict=True):
        signal.signal(number, handler)


class Daemon:
    """Counts how often it is told to end."""

    def __init__(self) -> None:
        self.ends = 0

    def end(self) -> None:
        self.ends += 1


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 0), (signal.SIGINT, 130)])
def test_an_end_that_was_swallowed_during_the_set_up_is_not_lost(
    number: signal.Signals, code: int
) -> None:
    signals, daemon = Signals(), Daemon()
    with suppress(SystemExit):  # as an import or a finaliser may
        signal.raise_signal(number)
    signals.ends(daemon)
    assert (daemon.ends, signals.exit_code) == (1, code)


def test_a_daemon_is_ended_once_and_not_before_it_is_told() -> None:
    signals, daemon = Signals(), Daemon()
    signals.ends(daemon)
    assert daemon.ends == 0
    signal.raise_signal(signal.SIGTERM)
    assert daemon.ends == 1


HANGING = """
import os, signal, sys, threading
from mocapd.app.daemon.main_loop import Signals
class Daemon:
    def end(self): os.write(1, b"asked\\n")  # print refuses while the signal interrupts another one
signals = Signals(within_s=1.0)
signals.ends(Daemon())
print("ready", flush=True)
hangs = threading.Lock(); hangs.acquire(); hangs.acquire()
"""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 0), (signal.SIGINT, 130)])
def test_a_daemon_whose_end_hangs_is_over_all_the_same(number: signal.Signals, code: int) -> None:
    words = (sys.executable, "-c", HANGING)
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(number)
        out, err = process.communicate(timeout=600)
    assert (process.returncode, out) == (code, "asked\n")
    assert "the orderly end takes longer than" in err
