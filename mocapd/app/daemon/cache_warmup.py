"""Warms up the caches of a first start in child processes, as only their end frees the memory of compiling."""

import logging
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING

from mocapd.app.daemon.forked_child import forked
from mocapd.file_lock import one_at_a_time
from mocapd.session.prepared_marker import LOCK, is_prepared, remember

if TYPE_CHECKING:
    from mocapd.app.daemon.task_pool import Progress
    from mocapd.config.sections import Config

_DATABASE = " database"  # only the database, no compiled kernels
FIRST_AFTER_S = 1.0  # shorter work is not logged [s]
_BEGUN = "compiling, once on this machine"  # until the preparation says more
_READY = "\0"  # message: a stream can begin
_LOOK_S = 0.2  # poll interval of a waiting caller, which signals may interrupt [s]
_MOST_PROCESSES = 4  # each takes up to 300 MB
_OPENING_S = 4.0  # to build the tracker from caches, on the reference machine

_log = logging.getLogger(__name__)
Report = Callable[[str], None]


def _quiet(*_: object) -> None:
    """Ignores progress."""


class Preparation:
    """Preparation in a child process. `is_needed`: False if everything is cached."""

    def __init__(self, child: BaseProcess | None, messages: Connection | None = None) -> None:
        self._child, self._messages = child, messages
        self.is_needed, self._is_ready = child is not None, False
        self._words = _BEGUN

    @property
    def is_over(self) -> bool:
        """True after its end, successful or not."""
        return self._child is None or not self._child.is_alive()

    def newest(self) -> str:
        """The progress, for users; empty when it is over."""
        self._words = "" if self.is_over else self._receive(self._words, 0.0)
        return self._words

    def wait(self, report: Report = _quiet) -> None:
        """Waits until a stream can begin or the child ends; reports the progress, for users."""
        began_s, has_logged = time.monotonic(), False
        has_bars = sys.stderr.isatty()  # the child's progress bars replace log lines
        while not self.is_over and not self._is_ready:
            self._words = self._receive(self._words, _LOOK_S)
            if time.monotonic() - began_s > FIRST_AFTER_S:
                report(self._words)
                if not has_bars and not has_logged and self._words != _BEGUN:
                    has_logged = True
                    _log.info("%s", self._words)
        if has_logged:
            _log.info("prepared after %.0f s", time.monotonic() - began_s)

    def _receive(self, words: str, within_s: float) -> str:
        """The newest message, else `words`."""
        assert self._child is not None
        if self._messages is None:
            self._child.join(within_s)
            return words
        with suppress(EOFError):  # the child is ending
            while self._messages.poll(within_s):
                message, within_s = self._messages.recv(), 0.0
                if message == _READY:
                    self._is_ready = True
                else:
                    words = message
            return words
        self._child.join(within_s)
        return words


@contextmanager
def prepare_in_background(config: "Config") -> Iterator[Preparation]:
    """Runs `prepare_in_processes` in a child process, which ends with the block; this process may start threads.

    Call it while the process has one thread.
    """
    if is_prepared(config):
        yield Preparation(None)
        return
    import mocapd.session.session  # noqa: F401  imported once for all children

    here, there = Pipe(duplex=False)
    with here, forked(prepare_in_processes, config, there.send) as child:
        there.close()
        yield Preparation(child, here)


def prepare_in_processes(config: "Config", report: Report = _quiet) -> None:
    """Makes the missing caches of this code and tracker in child processes; reports the progress.

    Failures are silent here, as the caller's own attempt reports them. The children end with the caller; an interrupted
    cache, or one that a full disk did not take, is rebuilt next time. Call it while the process has one thread.
    """
    if is_prepared(config):
        return
    import mocapd.session.session  # noqa: F401  see above
    from mocapd.app.daemon.first_start_tasks import has_tasks
    from mocapd.trackers.registry import has_caches

    prepare = _run_tasks if has_tasks(config.tracker.name) else _open_once
    with one_at_a_time(config.cache_dir, LOCK):
        if is_prepared(config):  # by another process
            return
        if prepare(config, report) and has_caches(config.tracker.name, config.cache_dir):
            remember(config)


def _run_tasks(config: "Config", report: Report) -> bool:
    """True if all tasks succeeded."""
    from mocapd.app.daemon.first_start_tasks import first_start_tasks, machine_pace
    from mocapd.app.daemon.task_pool import run_tasks
    from mocapd.app.terminal.progress import ProgressBars

    tasks = first_start_tasks(config)
    processes = min(_MOST_PROCESSES, len(os.sched_getaffinity(0)), len(tasks))
    with ProgressBars() as bars:
        has_begun = False

        def on_progress(progress: "Progress") -> None:
            nonlocal has_begun
            if not has_begun:
                has_begun = True
                total = _about(progress.left_s + progress.pace * _OPENING_S)
                headline = (
                    f"compiling the tracker, and making what later starts find: {total}, once"
                )
                bars.begin(headline)
                report(headline)
            for what, share in progress.shares.items():
                bars(what, round(100 * share), 100)
            report(_progress_text(progress))

        return run_tasks(tasks, processes, on_progress, machine_pace(), lambda: report(_READY))


def _about(seconds: float) -> str:
    """A rounded duration, for users."""
    if seconds < 90.0:
        step_s = 5 if seconds < 30.0 else 10
        return f"about {max(1, round(seconds / step_s)) * step_s} s"
    return f"about {seconds / 60.0:.0f} minutes"


def _progress_text(progress: "Progress") -> str:
    """The remaining preparations, for users."""
    open_shares = [
        f"{what} {100 * share:.0f} %" for what, share in progress.shares.items() if share < 1.0
    ]
    if not open_shares:
        return "once on this machine: done in a moment"
    return f"once on this machine: {', '.join(open_shares)}; {_about(progress.left_s)} left"


def _open_once(config: "Config", report: Report) -> bool:
    """Builds a tracker without a kernel table once, in a child process. True on success."""
    from mocapd.capture.kinds.source_kinds import is_simulated

    report("compiling the tracker, once on this machine")
    # film and database in parallel, then the session, which needs both; with real cameras only the session, which
    # reports their errors at once
    simulated = any(is_simulated(camera.source) for camera in config.camera)
    first = (_make_film, _make_database) if simulated else ()
    return _all_succeed(config, first) and _all_succeed(config, (_open,))


@contextmanager
def database_in_background(config: "Config") -> Iterator[None]:
    """Makes a missing pose database in a child process, which ends with the block.

    Later steps of a setup need it and wait for it. An existing file is not checked: the code that needs it rebuilds a
    damaged one and reports failures. Call it while the process has one thread.
    """
    from mocapd.trackers.registry import has_caches

    if is_prepared(config, _DATABASE) and has_caches(config.tracker.name, config.cache_dir):
        yield
        return
    with forked(_make_database_quietly, config):
        yield


def _all_succeed(config: "Config", works: Sequence[Callable[["Config"], None]]) -> bool:
    """Runs each work in a child process; True if all succeed."""
    with ExitStack() as stack:
        for child in [stack.enter_context(forked(work, config)) for work in works]:
            child.join()
            if child.exitcode != 0:
                return False
    return True


def _make_film(config: "Config") -> None:
    """Renders the simulated webcams' film, without a bar: the database takes longer."""
    from mocapd.capture.kinds.source_kinds import open_origin, origin_of

    for origin in {origin_of(camera.source) for camera in config.camera}:
        open_origin(origin, config.cache_dir, _quiet)


def _make_database(config: "Config") -> None:
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.session.tracker_setup import make_caches

    with ProgressBars() as progress:
        progress("pose database", 0, 100)  # visible while its kernels are compiled
        make_caches(config.tracker.name, config.cache_dir, progress)


def _make_database_quietly(config: "Config") -> None:
    from mocapd.session.tracker_setup import make_caches

    os.nice(5)  # the board detector runs meanwhile
    make_caches(config.tracker.name, config.cache_dir, _quiet)
    remember(config, _DATABASE)


def _open(config: "Config") -> None:
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.session.session import open_session

    with ProgressBars() as progress:
        progress.begin("preparing the tracker")
        open_session(config, progress)
