"""The first start in processes of their own: compiling and building takes memory that only its end gives back."""

import logging
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING

from mocapd.child_process import end_with_parent
from mocapd.errors import MocapdError
from mocapd.file_lock import one_at_a_time
from mocapd.session.prepared_marker import LOCK, is_prepared, remember

if TYPE_CHECKING:
    from mocapd.app.daemon.task_pool import Progress
    from mocapd.config.sections import Config

_DATABASE = " database"  # alone, without the tracker's code compiled
FIRST_AFTER_S = 1.0  # what takes less, such as being refused, is not worth a line [s]
_BEGUN = "compiling, once on this machine"  # until the preparation says more
_READY = "\0"  # what is said when a stream can begin
_LOOK_S = 0.2  # how often whoever waits can be interrupted [s]
_MOST_PROCESSES = 4  # each takes up to 300 MB
_OPENING_S = 4.0  # to build the tracker from what was prepared, on the figures' machine

_log = logging.getLogger(__name__)
Tell = Callable[[str], None]


def _quiet(*_: object) -> None:
    """Nobody listens."""


class Preparation:
    """What is prepared beside the process that began it. `is_needed`: whether there is anything to do."""

    def __init__(self, child: BaseProcess | None, said: Connection | None = None) -> None:
        self._child, self._said = child, said
        self.is_needed, self._is_ready = child is not None, False
        self._words = _BEGUN

    @property
    def is_over(self) -> bool:
        """Whether nothing is prepared any more, well or not."""
        return self._child is None or not self._child.is_alive()

    def newest(self) -> str:
        """Where it stands, in words for people; empty when it is over."""
        self._words = "" if self.is_over else self._hear(self._words, 0.0)
        return self._words

    def wait(self, tell: Tell = _quiet) -> None:
        """Until a stream can begin, or it is over, well or not; `tell` hears where it stands, in words for people."""
        began_s, told = time.monotonic(), False
        has_bars = sys.stderr.isatty()  # the preparation's own, which say it better
        while not self.is_over and not self._is_ready:
            self._words = self._hear(self._words, _LOOK_S)
            if time.monotonic() - began_s > FIRST_AFTER_S:
                tell(self._words)
                if not has_bars and not told and self._words != _BEGUN:
                    told = True
                    _log.info("%s", self._words)
        if told:
            _log.info("prepared after %.0f s", time.monotonic() - began_s)

    def _hear(self, words: str, within_s: float) -> str:
        """What was said last."""
        assert self._child is not None
        if self._said is None:
            self._child.join(within_s)
            return words
        with suppress(EOFError):  # it is about to end
            while self._said.poll(within_s):
                said, within_s = self._said.recv(), 0.0
                if said == _READY:
                    self._is_ready = True
                else:
                    words = said
            return words
        self._child.join(within_s)
        return words


@contextmanager
def preparing_apart(config: "Config") -> Iterator[Preparation]:
    """`prepare_apart` in a process beside this one, which may go on and have threads; it ends with the block.

    Called while the process has one thread.
    """
    if is_prepared(config):
        yield Preparation(None)
        return
    import mocapd.session.session  # noqa: F401  all that the processes need, imported once for them

    fork = multiprocessing.get_context("fork")
    here, there = fork.Pipe(duplex=False)
    child = fork.Process(target=_work, args=(prepare_apart, config, there.send))
    child.start()
    there.close()
    try:
        yield Preparation(child, here)
    finally:
        child.kill()
        child.join()
        here.close()


def prepare_apart(config: "Config", tell: Tell = _quiet) -> None:
    """Make the caches that this code and tracker need, in processes of their own, unless that was done before;
    `tell` hears where it stands.

    A failure is not told here: the caller comes upon it again, and tells it. What ends the
    caller ends the work too; what is half made is made anew next time. Called while the process has
    one thread.
    """
    if is_prepared(config):
        return
    import mocapd.session.session  # noqa: F401  see above
    from mocapd.app.daemon.first_start_tasks import has_tasks

    prepare = _run_tasks if has_tasks(config.tracker.name) else _open_once
    with one_at_a_time(config.cache_dir, LOCK):
        if not is_prepared(config) and prepare(config, tell):  # by whom we waited for
            remember(config)


def _run_tasks(config: "Config", tell: Tell) -> bool:
    """Whether all came to a good end."""
    from mocapd.app.daemon.first_start_tasks import first_start_tasks, machine_pace
    from mocapd.app.daemon.task_pool import run_tasks
    from mocapd.app.terminal.progress import ProgressBars

    tasks = first_start_tasks(config)
    processes = min(_MOST_PROCESSES, len(os.sched_getaffinity(0)), len(tasks))
    pace = machine_pace()
    total_s = pace * (sum(task.seconds for task in tasks) / processes + _OPENING_S)
    headline = f"compiling the tracker, and making what later starts find: {_about(total_s)}, once"
    with ProgressBars() as bars:
        bars.begin(headline)

        def hear(progress: "Progress") -> None:
            for what, share in progress.shares.items():
                bars(what, round(100 * share), 100)
            tell(_progress_text(progress))

        tell(headline)
        return run_tasks(tasks, processes, hear, pace, lambda: tell(_READY))


def _about(seconds: float) -> str:
    """A duration as one says it."""
    if seconds < 90.0:
        return f"about {max(1, round(seconds / 10.0)) * 10} s"
    return f"about {seconds / 60.0:.0f} minutes"


def _progress_text(progress: "Progress") -> str:
    """What is still prepared, in words for people."""
    open_shares = [
        f"{what} {100 * share:.0f} %" for what, share in progress.shares.items() if share < 1.0
    ]
    return f"once on this machine: {', '.join(open_shares)}; {_about(progress.left_s)} left"


def _open_once(config: "Config", tell: Tell) -> bool:
    """For trackers whose kernels no table knows: build it once, in a process of its own. Whether all ended well."""
    from mocapd.capture.kinds.source_kinds import is_simulated

    tell("compiling the tracker, once on this machine")
    # what takes longest side by side, then what needs both; with real cameras `_open` is alone, as
    # it tells at once what is wrong with them
    simulated = any(is_simulated(camera.source) for camera in config.camera)
    first = (_make_film, _make_database) if simulated else ()
    return _all_end_well(config, first) and _all_end_well(config, (_open,))


@contextmanager
def database_beside(config: "Config") -> Iterator[None]:
    """Makes the pose database, if there is none, in a process beside this one; it ends with the block.

    A setup's first steps take longer than that, its later ones need it: they wait for what is under
    way. What this code has made or found before is not looked at again while the file is there: should it be
    damaged, who needs it makes it anew. Called while the process has one thread. A failure is told by whoever
    needs it.
    """
    from mocapd.trackers.registry import has_caches

    if is_prepared(config, _DATABASE) and has_caches(config.tracker.name, config.cache_dir):
        yield
        return
    child = multiprocessing.get_context("fork").Process(
        target=_work, args=(_make_database_quietly, config)
    )
    child.start()
    try:
        yield
    finally:
        child.kill()
        child.join()


def _all_end_well(config: "Config", works: Sequence[Callable[["Config"], None]]) -> bool:
    """Whether all of these, each in a process of its own, came to a good end."""
    fork = multiprocessing.get_context("fork")
    children = [fork.Process(target=_work, args=(work, config)) for work in works]
    try:
        for child in children:
            child.start()
        for child in children:
            child.join()
            if child.exitcode != 0:
                return False
        return True
    finally:
        for child in children:
            if child.pid is not None:
                child.kill()


def _work(work: Callable[..., None], *arguments: object) -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    assert parent.pid is not None
    end_with_parent(parent.pid, signal.SIGKILL)
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    try:
        work(*arguments)
    except MocapdError:
        os._exit(1)


def _make_film(config: "Config") -> None:
    """What the simulated webcams show; its bar gives way to the database's, which takes longer."""
    from mocapd.capture.kinds.source_kinds import open_origin, origin_of

    for origin in {origin_of(camera.source) for camera in config.camera}:
        open_origin(origin, config.cache_dir, _quiet)


def _make_database(config: "Config") -> None:
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.session.tracker_setup import make_caches

    with ProgressBars() as progress:
        progress("pose database", 0, 100)  # something to see while its maker is compiled
        make_caches(config.tracker.name, config.cache_dir, progress)


def _make_database_quietly(config: "Config") -> None:
    from mocapd.session.tracker_setup import make_caches

    os.nice(5)  # the board is looked for meanwhile
    make_caches(config.tracker.name, config.cache_dir, _quiet)
    remember(config, _DATABASE)


def _open(config: "Config") -> None:
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.session.session import open_session

    with ProgressBars() as progress:
        progress.begin("preparing the tracker")
        open_session(config, progress)
