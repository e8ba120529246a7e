"""What daemons of these tests are started with: signals as a terminal gives them."""

import signal
from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True, scope="module")
def usual_signals() -> Iterator[None]:
    """Children inherit what is ignored here: under nohup, or in the background of a script."""
    ends = signal.SIGHUP, signal.SIGINT
    ignored = [number for number in ends if signal.getsignal(number) is signal.SIG_IGN]
    for number in ignored:
        signal.signal(number, signal.SIG_DFL)
    yield
    for number in ignored:
        signal.signal(number, signal.SIG_IGN)
