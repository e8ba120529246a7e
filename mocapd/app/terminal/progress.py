"""Progress of long work on stderr: bars on a terminal, else a line per part and minute; nothing in the journal."""

import sys
import threading
import time
from types import TracebackType

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
)

from mocapd.app.terminal.logs import stderr_is_journal

FIRST_AFTER_S = 2.0  # shorter work is not reported without a terminal [s]
REPORT_EVERY_S = 60.0


def say(line: str) -> None:
    """One plain line on stderr."""
    print(line, file=sys.stderr, flush=True)


class ProgressBars:
    """Call it with (what, done, total); each `what` gets a bar.

    Without a terminal it also prints during a long part: compiling a kernel may take minutes on a small machine. In the
    journal it is silent: its readers want events, not progress.
    """

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        self._is_quiet = stderr_is_journal()
        self._bars = Progress(
            TextColumn("{task.description}", markup=False),  # names of files may hold brackets
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),  # moves also while a single part takes long
            console=self._console,
        )
        self._tasks: dict[str, TaskID] = {}
        self._lines: _Lines | None = None

    def __enter__(self) -> "ProgressBars":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._tasks:
            self._bars.stop()
        if self._lines is not None:
            self._lines.end(well=error is None)

    def __call__(self, what: str, done: int, total: int) -> None:
        """Reports that `done` of `total` parts are finished."""
        if self._is_quiet:
            return
        if not self._console.is_terminal:
            self.begin(what)
            assert self._lines is not None
            self._lines.at(what, done, total)
            return
        if not self._tasks:
            self._bars.start()
        if what not in self._tasks:
            self._tasks[what] = self._bars.add_task(what)
        self._bars.update(self._tasks[what], completed=done, total=total)

    def begin(self, what: str) -> None:
        """Sets the headline: printed above the bars, or as first line of long work without a terminal."""
        if self._is_quiet or self._lines is not None or self._tasks:
            return
        if self._console.is_terminal:
            self._console.print(what, markup=False, highlight=False)
        else:
            self._lines = _Lines(what)


class _Lines:
    """Prints the headline, the progress once a minute, and the end of each part, from a thread."""

    def __init__(self, what: str) -> None:
        self._began_s, self._headline = time.monotonic(), what
        self._parts: dict[str, tuple[int, int]] = {}
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._has_printed = False
        self._thread = threading.Thread(target=self._run, name="progress", daemon=True)
        self._thread.start()

    def at(self, what: str, done: int, total: int) -> None:
        """Updates a part; reports its end at once."""
        with self._lock:
            before = self._parts.get(what)
            self._parts[what] = done, total
        if self._has_printed and before is not None and before[0] < before[1] and done >= total:
            say(f"{what}: done after {self._spent_s():.0f} s")

    def end(self, well: bool) -> None:
        """Ends the thread; reports the finished parts if anything was printed before."""
        self._over.set()
        self._thread.join()
        if self._has_printed and well:
            for what in self._open_parts():
                say(f"{what}: done after {self._spent_s():.0f} s")

    def _spent_s(self) -> float:
        return time.monotonic() - self._began_s

    def _open_parts(self) -> dict[str, tuple[int, int]]:
        with self._lock:
            parts = dict(self._parts) or {self._headline: (0, 1)}
        return {what: part for what, part in parts.items() if part[0] < part[1]}

    def _run(self) -> None:
        if self._over.wait(FIRST_AFTER_S):
            return
        self._has_printed = True
        say(self._headline)
        while not self._over.wait(REPORT_EVERY_S):
            parts = [
                f"{what}: {100 * a // max(1, b)} %" for what, (a, b) in self._open_parts().items()
            ]
            if parts:
                say(f"{', '.join(parts)}, {self._spent_s():.0f} s so far")
