"""What a daemon prepares before its first frame, read from the lines that it writes to stderr."""

import re
import sys
import threading
from typing import IO

# such as `compiling: 43 %, film: 5 %, 62 s so far`
_PROGRESS = re.compile(r"(?P<shares>(?:[^:,]+: \d+ %, )+)\d+ s so far")


class DaemonProgress:
    """Reads the daemon's stderr to its end, in a thread, and passes every line on to ours."""

    def __init__(self, stderr: IO[str]) -> None:
        self._newest = ""
        self._thread = threading.Thread(
            target=self._read, args=(stderr,), name="daemon-progress", daemon=True
        )
        self._thread.start()

    def text(self, spent_s: float) -> str:
        """One line for the player; spent_s: since the daemon was started [s]."""
        minutes, seconds = divmod(int(spent_s), 60)
        spent = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
        return f"Preparing the demo: {self._newest}{spent} so far"

    def close(self) -> None:
        """The daemon has ended: wait for its last line."""
        self._thread.join(1.0)

    def _read(self, stderr: IO[str]) -> None:
        with stderr:
            for line in stderr:
                found = _PROGRESS.fullmatch(line.strip())
                if found is not None:
                    self._newest = found["shares"].replace(":", "")
                sys.stderr.write(line)
