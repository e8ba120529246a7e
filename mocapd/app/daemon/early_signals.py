"""Handles signals during the imports of a command: the process ends at once, with the usual exit code.

Imports only modules that the interpreter has already loaded. An exception would not do: an import may swallow it or
print a traceback.
"""

import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType

SIGINT_EXIT = 130
SERVICES = ("run", "demo", "calibrate", "camera-node")
"""Commands that end with 0 after a signal. Other commands are unfinished then and die of the signal."""
RELOADING = ("run", "demo")
"""The commands that reload their configuration at a SIGHUP without a terminal."""


class EarlySignal:
    """A signal handler that records the signal for a later handler."""

    def __init__(self) -> None:
        self.has_come = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        self.has_come = True


def on_terminal() -> bool:
    """True if the process has a terminal, which may be closed."""
    return any(os.isatty(fd) for fd in (0, 1, 2))


def end_at_once(words: Sequence[str]) -> None:
    """Installs the handlers, until `Signals` or `interruptible` replaces them. words: the command line."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    if is_service(words):
        for number in (signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) is signal.SIG_DFL:  # under nohup it is ignored
                reloads = number == signal.SIGHUP and words[1] in RELOADING and not on_terminal()
                signal.signal(number, EarlySignal() if reloads else _end)


def interruptible(words: Sequence[str]) -> None:
    """Makes Ctrl-C an exception again at the start of a command that is no service."""
    if not is_service(words) and signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def ignore_signals() -> None:
    """Ignores signals after the end of the command, so that they do not change the exit code.

    The interpreter restores their default effect while it exits, which would kill the process.
    """
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        if callable(signal.getsignal(number)):
            signal.signal(number, signal.SIG_IGN)


def is_service(words: Sequence[str]) -> bool:
    """True if this command line starts a service, which runs until a signal."""
    batch = any(word.startswith("--from-folder") for word in words)
    return len(words) > 1 and words[1] in SERVICES and not batch


def _end(number: int, _frame: FrameType | None) -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    os._exit(SIGINT_EXIT if number == signal.SIGINT else 0)
