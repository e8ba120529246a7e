"""Logs on stderr: plain for a terminal, with priorities for the systemd journal."""

import logging
import os
import sys
from typing import TextIO

# sd-daemon(3): a line that begins with <N> carries its syslog priority
_PRIORITY = {
    logging.DEBUG: 7,
    logging.INFO: 6,
    logging.WARNING: 4,
    logging.ERROR: 3,
    logging.CRITICAL: 2,
}


class JournalFormatter(logging.Formatter):
    """`<N>` before every line; the journal adds the time itself."""

    def format(self, record: logging.LogRecord) -> str:
        """One or more lines, each with its priority."""
        prefix = f"<{_PRIORITY.get(record.levelno, 6)}>"
        lines = f"{record.name}: {super().format(record)}".splitlines()
        return "\n".join(prefix + line for line in lines)


def stderr_is_journal() -> bool:
    """True if stderr is the stream of JOURNAL_STREAM; a child's may be redirected."""
    stat = os.fstat(sys.stderr.fileno())
    return os.environ.get("JOURNAL_STREAM") == f"{stat.st_dev}:{stat.st_ino}"


class StderrHandler(logging.StreamHandler[TextIO]):
    """Writes to the current sys.stderr: above a progress bar or status line, if any."""

    def emit(self, record: logging.LogRecord) -> None:
        self.stream = sys.stderr
        super().emit(record)


def set_up_logs(level: str) -> None:
    """Send every log of at least this level to stderr."""
    handler = StderrHandler()
    if stderr_is_journal():
        handler.setFormatter(JournalFormatter())
    else:
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname).1s %(name)s: %(message)s"))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
