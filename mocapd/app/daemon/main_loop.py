"""What `run` and `demo` share: signals, the status line, and how the process ends."""

import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable, Sequence
from types import FrameType
from typing import Protocol

from mocapd.app.daemon.early_signals import SIGINT_EXIT, ComesEarly, on_terminal
from mocapd.app.daemon.end_deadline import EndDeadline
from mocapd.app.terminal.status_line import StatusLine
from mocapd.service.service import Service, Snapshot, ThreadDiedError

SHOW_EVERY_S = 0.25  # how often the status line changes [s]
TELL_EVERY = (
    4  # health goes out with every fourth of them, and when something has happened to a camera
)

END_S = 1.7  # from a signal to the end of a daemon [s]: two seconds are promised
JOIN_S = 0.2  # what idle threads may take to end [s]

INTERNAL_ERROR = 70  # EX_SOFTWARE


class Stoppable(Protocol):
    """Something that runs until it is told to end."""

    def end(self) -> None: ...


class Signals:
    """SIGTERM and SIGHUP end with 0 and SIGINT with 130: at once while things are set up, then in order.

    SIGHUP is what a terminal sends that is closed; under nohup it is ignored. With `reloads` and without a
    terminal it asks for the configuration to be read again instead, see `take_reload`. A second signal has
    its default effect, should the orderly end hang, apart from SIGHUP, which comes several times.

    While things are set up the end is an exception, which may be swallowed where it is raised (in a finaliser,
    in the midst of an import): then it comes as soon as there is something to end.
    """

    def __init__(self, reloads: bool = False, within_s: float | None = None) -> None:
        """within_s: how long the orderly end may take [s]; None: as long as it takes."""
        self.exit_code = 0
        self._deadline = None if within_s is None else EndDeadline(within_s, lambda: self.exit_code)
        self._daemon: Stoppable | None = None
        self._is_told = False
        self._terminals = [fd for fd in (1, 2) if os.isatty(fd)]
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._caught)
        self._reload = False
        before = signal.getsignal(signal.SIGHUP)
        if before is not signal.SIG_IGN:
            asks = reloads and not on_terminal()
            signal.signal(signal.SIGHUP, self._asked if asks else self._caught)
            # it may have come while nobody could read anything again
            self._reload = asks and isinstance(before, ComesEarly) and before.came

    def ends(self, daemon: Stoppable) -> None:
        """From now on a signal ends this in order; also one that came before."""
        self._daemon = daemon
        if self._deadline is not None:
            self._deadline.start()
        if self._is_told:
            self._end(daemon)

    def _end(self, daemon: Stoppable) -> None:
        if self._deadline is not None:
            self._deadline.begin()
        daemon.end()

    def take_reload(self) -> bool:
        """Whether the configuration is to be read again; told once."""
        asked, self._reload = self._reload, False
        return asked

    def _asked(self, _number: int, _frame: FrameType | None) -> None:
        self._reload = True

    def _caught(self, number: int, _frame: FrameType | None) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        _silence(fd for fd in self._terminals if not os.isatty(fd))
        self.exit_code = SIGINT_EXIT if number == signal.SIGINT else 0
        self._is_told = True
        if self._daemon is None:
            sys.exit(self.exit_code)
        self._end(self._daemon)


def _silence(gone: Iterable[int]) -> None:
    """What is written to a terminal that is gone must not fail: the orderly end comes after it."""
    for fd in gone:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, fd)
        os.close(nowhere)


class LoopHook(Protocol):
    """What goes on beside the service, in the main thread."""

    def on_tick(self, snapshot: Snapshot) -> None:
        """Called several times a second; may replace the service's session."""
        ...

    def let_go(self) -> None:
        """The service is about to end; never blocks for long."""
        ...


def run_daemon(
    service: Service,
    signals: Signals,
    hint: str = "",
    hooks: Sequence[LoopHook] = (),
    remark: Callable[[], str] = str,
) -> int:
    """Run until it ends; the exit code. remark: what else the status line says. Raises MocapdError when a named error
    killed a thread."""
    # a thread nobody watches must not die unseen either
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
                    if ticks % TELL_EVERY == 0 or service.has_news(snapshot):
                        service.tell(snapshot)
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
    """End the process at once when threads still work on what nobody waits for any more.

    The interpreter would wait for them: the pose database takes half a minute, a kernel to compile
    some seconds, and neither can be told to stop.
    """
    until_s = time.monotonic() + JOIN_S
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join(max(0.0, until_s - time.monotonic()))
            if thread.is_alive():
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(exit_code)
