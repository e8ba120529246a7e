"""What `run` and `demo` share: signals, the status line, and how the process ends."""

import signal
import sys
import threading
import traceback
from types import FrameType

from mocapd.cli.status_line import StatusLine
from mocapd.daemon import Daemon, ThreadDiedError

SHOW_EVERY_S = 0.25  # how often the status line changes [s]
TELL_EVERY = 4  # health goes out with every fourth of them

INTERNAL_ERROR = 70  # EX_SOFTWARE
SIGINT_EXIT = 130


class Signals:
    """SIGTERM ends with 0 and SIGINT with 130: at once while things are set up, then in order.

    A second signal has its default effect, should the orderly end hang.
    """

    def __init__(self) -> None:
        self.exit_code = 0
        self._daemon: Daemon | None = None
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._caught)

    def ends(self, daemon: Daemon) -> None:
        """From now on a signal ends this daemon in order."""
        self._daemon = daemon

    def _caught(self, number: int, _frame: FrameType | None) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        self.exit_code = SIGINT_EXIT if number == signal.SIGINT else 0
        if self._daemon is None:
            sys.exit(self.exit_code)
        self._daemon.end()


def run_daemon(daemon: Daemon, signals: Signals, hint: str = "") -> int:
    """Run until it ends; the exit code. Raises MocapdError when a named error killed a thread."""
    # a thread nobody watches must not die unseen either
    threading.excepthook = lambda args: daemon.died(args.exc_value or RuntimeError(args.exc_type))
    signals.ends(daemon)
    try:
        with daemon, StatusLine() as line:
            if hint:
                print(hint, flush=True)
            beats = 0
            while not daemon.wait(SHOW_EVERY_S):
                snapshot = daemon.snapshot()
                line.show(snapshot)
                if beats % TELL_EVERY == 0:
                    daemon.tell(snapshot)
                beats += 1
    except ThreadDiedError as error:
        traceback.print_exception(error.__cause__)
        return INTERNAL_ERROR
    return signals.exit_code
