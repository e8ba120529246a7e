"""What is over once and for all wakes everybody, also when a signal handler tells it at the worst of moments."""

import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from mocapd.errors import UnavailableError
from mocapd.latch import EndLatch, Latch, ThreadDiedError

# A timer interrupts the waiting thread some thousand times, at any instruction
INTERRUPTED = """
import signal, time
from mocapd.latch import Latch
told = 0
def handler(*_):
    global latch, told
    told += 1
    latch.set()
latch = Latch()
signal.signal(signal.SIGALRM, handler)
signal.setitimer(signal.ITIMER_REAL, 0.0002, 0.0002)
end = time.monotonic() + 1.0
while time.monotonic() < end:
    latch = Latch()
    while not latch.wait(0.00001):
        pass
signal.setitimer(signal.ITIMER_REAL, 0.0)
print(told)
"""


def test_a_signal_handler_may_tell_it_while_it_is_waited_for() -> None:
    run = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], check=True, capture_output=True, timeout=60.0, text=True
    )  # fmt: skip
    assert int(run.stdout) > 100


def test_everybody_who_waits_is_woken() -> None:
    latch = Latch()
    with ThreadPoolExecutor(3) as pool:
        waiting = [pool.submit(latch.wait, 30.0) for _ in range(3)]
        began_s = time.monotonic()
        latch.set()
        assert all(one.result() for one in waiting)
    assert time.monotonic() - began_s < 10.0
    assert latch.wait(0.0)
    assert latch.is_set()


def test_who_is_told_nothing_waits_no_longer_than_asked() -> None:
    latch = Latch()
    assert not latch.wait(0.01)
    assert not latch.wait(-1.0)
    assert not latch.is_set()


# A signal comes about as often as the time is up
UP_WHEN_INTERRUPTED = """
import signal
from mocapd.latch import Latch
signal.signal(signal.SIGALRM, lambda *_: None)
signal.setitimer(signal.ITIMER_REAL, 0.0007, 0.0007)
latch = Latch()
for _ in range(1000):
    assert not latch.wait(0.001)
signal.setitimer(signal.ITIMER_REAL, 0.0)
"""


def test_a_signal_as_the_time_is_up_does_not_make_it_wait_for_ever() -> None:
    subprocess.run([sys.executable, "-c", UP_WHEN_INTERRUPTED], check=True, timeout=60.0)


def test_what_ended_a_thread_first_is_raised_where_its_owner_waits() -> None:
    latch = EndLatch()
    assert not latch.wait(0.0)
    latch.died(KeyError("first"))
    latch.died(UnavailableError("second"))
    with pytest.raises(ThreadDiedError) as died:
        latch.wait(1.0)
    assert isinstance(died.value.__cause__, KeyError)
    latch = EndLatch()
    latch.died(UnavailableError("an expected one"))
    with pytest.raises(UnavailableError, match="an expected one"):
        latch.wait(1.0)
