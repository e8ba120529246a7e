"""Progress on stderr, for what takes long: bars on a terminal, else a plain line every ten seconds; none in the journal."""

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

FIRST_AFTER_S = 5.0  # where there is no terminal; what takes less is not worth a line [s]
TELL_EVERY_S = 10.0


def say(line: str) -> None:
    """One plain line on stderr."""
    print(line, file=sys.stderr, flush=True)


class ProgressBars:
    """Call it with (what, done, total); each `what` gets a bar. Nothing is shown before that.

    Without a terminal it tells also while a single part takes long: a kernel to compile may take
    minutes on a small machine. In the journal nothing is told: nobody waits there, and whoever reads it later
    wants to know what happened.
    """

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        self._is_quiet = stderr_is_journal()
        self._bars = Progress(
            TextColumn("{task.description}"),
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
        """`done` of `total` parts are made."""
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
        """Without a terminal: say it when it takes long to come to the first part."""
        if self._lines is None and not self._is_quiet and not self._console.is_terminal:
            self._lines = _Lines(what)


class _Lines:
    """Says where the newest of what is made stands, on its own time."""

    def __init__(self, what: str) -> None:
        self._began_s, self._headline = time.monotonic(), what
        self._newest = (what, 0, 1)  # replaced as a whole, so the thread needs no lock
        self._over = threading.Event()
        self._told = False
        self._thread = threading.Thread(target=self._run, name="progress", daemon=True)
        self._thread.start()

    def at(self, what: str, done: int, total: int) -> None:
        """What the next line says."""
        self._newest = what, done, total

    def end(self, well: bool) -> None:
        """Say that it is done, if anything was said before."""
        self._over.set()
        self._thread.join()
        if self._told and well:
            say(f"{self._newest[0]}: done after {time.monotonic() - self._began_s:.0f} s")

    def _run(self) -> None:
        if self._over.wait(FIRST_AFTER_S):
            return
        self._told = True
        say(self._headline)
        while not self._over.wait(TELL_EVERY_S):
            what, done, total = self._newest
            spent_s = time.monotonic() - self._began_s
            say(f"{what}: {100 * done // max(1, total)} %, {spent_s:.0f} s so far")
