"""The main loop of `run` and `demo`: signals, the status line, and the end of the process."""

import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable, Sequence
from types import FrameType
from typing import Protocol

from mocapd.app.daemon.early_signals import SIGINT_EXIT, EarlySignal, on_terminal
from mocapd.app.daemon.end_deadline import EndDeadline
from mocapd.app.terminal.status_line import StatusLine
from mocapd.latch import ThreadDiedError
from mocapd.service.service import Service, Snapshot

SHOW_EVERY_S = 0.25  # how often the status line changes [s]
PUBLISH_EVERY = 4  # health is published every fourth tick, and after a camera's change of state

END_S = 1.7  # from a signal to the end of a daemon [s]: two seconds are promised
JOIN_S = 0.2  # timeout of joining idle threads [s]

INTERNAL_ERROR = 70  # EX_SOFTWARE


class Stoppable(Protocol):
    """Something that runs until `end`."""

    def end(self) -> None: ...


class Signals:
    """SIGTERM and SIGHUP end the process with 0, SIGINT with 130: at once during the start, later in order.

    A closing terminal sends SIGHUP; under nohup it is ignored. With `reloads` and without a terminal SIGHUP requests a
    reload instead, see `take_reload`. A second signal has its default effect, in case the orderly end hangs, except
    SIGHUP, which comes several times. During the start the end is an exception, which a finaliser or import may
    swallow: `ends` then repeats it.
    """

    def __init__(self, reloads: bool = False, within_s: float | None = None) -> None:
        """within_s: deadline of the orderly end [s]; None: no deadline."""
        self.exit_code = 0
        self._deadline = None if within_s is None else EndDeadline(within_s, lambda: self.exit_code)
        self._daemon: Stoppable | None = None
        self._is_ending = False
        self._terminals = [fd for fd in (1, 2) if os.isatty(fd)]
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_end)
        self._reload = False
        before = signal.getsignal(signal.SIGHUP)
        if before is not signal.SIG_IGN:
            asks = reloads and not on_terminal()
            signal.signal(signal.SIGHUP, self._on_reload if asks else self._on_end)
            # a SIGHUP during the imports
            self._reload = asks and isinstance(before, EarlySignal) and before.has_come

    def ends(self, daemon: Stoppable) -> None:
        """Registers the daemon that signals end in order; ends it at once after an earlier signal."""
        self._daemon = daemon
        if self._deadline is not None:
            self._deadline.start()
        if self._is_ending:
            self._end(daemon)

    def _end(self, daemon: Stoppable) -> None:
        if self._deadline is not None:
            self._deadline.begin()
        daemon.end()

    def take_reload(self) -> bool:
        """True once after a request to reload."""
        asked, self._reload = self._reload, False
        return asked

    def _on_reload(self, _number: int, _frame: FrameType | None) -> None:
        self._reload = True

    def _on_end(self, number: int, _frame: FrameType | None) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        _silence(fd for fd in self._terminals if not os.isatty(fd))
        self.exit_code = SIGINT_EXIT if number == signal.SIGINT else 0
        self._is_ending = True
        if self._daemon is None:
            sys.exit(self.exit_code)
        self._end(self._daemon)


def _silence(gone: Iterable[int]) -> None:
    """Redirects closed terminals to /dev/null: writing to them would fail and disturb the orderly end."""
    for fd in gone:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, fd)
        os.close(nowhere)


class LoopHook(Protocol):
    """Additional work of the main loop, in the main thread."""

    def on_tick(self, snapshot: Snapshot) -> None:
        """Called several times a second; may replace the service's session."""
        ...

    def let_go(self) -> None:
        """Called before the service ends; must not block for long."""
        ...


def run_daemon(
    service: Service,
    signals: Signals,
    hint: str = "",
    hooks: Sequence[LoopHook] = (),
    remark: Callable[[], str] = str,
) -> int:
    """Runs until the service ends; returns the exit code. remark: a prefix of the status line. Raises the MocapdError
    that killed a thread."""
    # an exception in any thread must end the process
    threading.excepthook = lambda args: service.died(args.exc_value or RuntimeError(args.exc_type))
    signals.ends(service)
    try:
        with service, StatusLine() as line:
            if hint:
                print(hint, flush=True)
            ticks = 0
            try:
                while not service.wait(SHOW_EVERY_S):
                    service.watch()
                    snapshot = service.snapshot()
                    line.show(snapshot, remark())
                    if ticks % PUBLISH_EVERY == 0 or service.has_news(snapshot):
                        service.publish_status(snapshot)
                    ticks += 1
                    for hook in hooks:
                        hook.on_tick(snapshot)
            finally:
                for hook in hooks:
                    hook.let_go()
    except ThreadDiedError as error:
        traceback.print_exception(error.__cause__)
        return INTERNAL_ERROR
    return signals.exit_code


def end_despite_work(exit_code: int) -> None:
    """Ends the process at once while threads still work on abandoned results.

    The interpreter would wait for them: the pose database takes half a minute, compiling a kernel some seconds, and
    neither can be interrupted.
    """
    until_s = time.monotonic() + JOIN_S
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join(max(0.0, until_s - time.monotonic()))
            if thread.is_alive():
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(exit_code)
