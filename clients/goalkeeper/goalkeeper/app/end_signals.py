"""SIGTERM and a closed terminal end the game in order, so that what it started is ended, too."""

import signal
from types import FrameType


def end_on_signals() -> None:
    """From now on they raise SystemExit in the main thread."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)  # Windows has no SIGHUP
        # under nohup it is ignored
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _end)


def _end(number: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + number)
