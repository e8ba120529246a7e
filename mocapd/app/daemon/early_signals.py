"""Signals while the command is still being imported: the process ends at once, with the code it always has.

Imports nothing but what the interpreter has loaded already. An exception would not do: raised in the
midst of an import it may be swallowed there, or leave a traceback.
"""

import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType

SIGINT_EXIT = 130
SERVICES = ("run", "demo", "calibrate", "camera-node")
"""Commands that end with 0 when they are told to end. The others had something to finish, and did not:
they die of the signal."""
RELOADING = ("run", "demo")
"""Of these the commands that a SIGHUP without a terminal tells to read their configuration again."""


class ComesEarly:
    """Takes a signal for whoever will have a use for it."""

    def __init__(self) -> None:
        self.came = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        self.came = True


def on_terminal() -> bool:
    """Whether there is a terminal that may be closed."""
    return any(os.isatty(fd) for fd in (0, 1, 2))


def end_at_once(words: Sequence[str]) -> None:
    """Until `Signals` takes over, or `interruptible` is called. words: of the command line."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    if is_service(words):
        for number in (signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) is signal.SIG_DFL:  # under nohup it is ignored
                reloads = number == signal.SIGHUP and words[1] in RELOADING and not on_terminal()
                signal.signal(number, ComesEarly() if reloads else _end)


def interruptible(words: Sequence[str]) -> None:
    """The command begins: unless it is a service, Ctrl-C is an exception again, which it may catch."""
    if not is_service(words) and signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def ended() -> None:
    """The command is over, and its exit code is known: a signal that was looked after until now changes it no more.

    The interpreter gives such signals their default effect while it ends, by which the process would die of them.
    """
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        if callable(signal.getsignal(number)):
            signal.signal(number, signal.SIG_IGN)


def is_service(words: Sequence[str]) -> bool:
    """Whether this command line starts something that runs until it is told to end."""
    batch = any(word.startswith("--from-folder") for word in words)
    return len(words) > 1 and words[1] in SERVICES and not batch


def _end(number: int, _frame: FrameType | None) -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    os._exit(SIGINT_EXIT if number == signal.SIGINT else 0)
