"""Progress on stderr, for what is made at the first start: bars on a terminal, else lines in the log."""

import logging
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

TELL_EVERY_S = 5.0  # where there is no terminal; what takes less is not worth a line [s]

_log = logging.getLogger(__name__)


class ProgressBars:
    """Call it with (what, done, total); each `what` gets a bar. Nothing is shown before that."""

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),  # moves also while a single part takes long
            console=self._console,
        )
        self._tasks: dict[str, TaskID] = {}
        self._told_s: dict[str, float] = {}

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

    def __call__(self, what: str, done: int, total: int) -> None:
        """`done` of `total` parts are made."""
        if not self._console.is_terminal:
            self._tell(what, done, total)
            return
        if not self._tasks:
            self._bars.start()
        if what not in self._tasks:
            self._tasks[what] = self._bars.add_task(what)
        self._bars.update(self._tasks[what], completed=done, total=total)

    def _tell(self, what: str, done: int, total: int) -> None:
        now_s = time.monotonic()
        if now_s - self._told_s.setdefault(what, now_s) >= TELL_EVERY_S:
            self._told_s[what] = now_s
            _log.info("%s: %d of %d", what, done, total)
