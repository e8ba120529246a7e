"""The first start in processes of their own: compiling and building takes memory that only its end gives back."""

import hashlib
import logging
import multiprocessing
import os
import platform
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import TYPE_CHECKING

import mocapd
from mocapd.boundary.files import read_text
from mocapd.child_process import end_with_parent
from mocapd.errors import InputError, MocapdError
from mocapd.whole_file import whole_file

if TYPE_CHECKING:
    from mocapd.config.sections import Config

MARKER = "prepared"  # in the cache folder: what was prepared for, one a line
REMEMBERED = 8
_MOST_BYTES = 1 << 16
_DATABASE = " database"  # alone, without the tracker's code compiled
_COMPILING = "compiling the tracker (once on this machine, some minutes on a slow one)"
FIRST_AFTER_S = 1.0  # what takes less, such as being refused, is not worth a line [s]
_LOOK_S = 0.2  # how often whoever waits can be interrupted [s]

_log = logging.getLogger(__name__)


class Preparation:
    """What is prepared beside the process that begun it. `is_needed`: whether there is anything to do."""

    def __init__(self, child: BaseProcess | None) -> None:
        self._child = child
        self.is_needed = child is not None

    def wait(self) -> None:
        """Until it is over, well or not."""
        began_s, told = time.monotonic(), False
        bars = sys.stderr.isatty()  # the children's, which say it better
        while self._child is not None and self._child.is_alive():
            self._child.join(_LOOK_S)
            if not told and not bars and time.monotonic() - began_s > FIRST_AFTER_S:
                told = True
                _log.info(_COMPILING)
        if told:
            _log.info("prepared after %.0f s", time.monotonic() - began_s)


@contextmanager
def preparing_apart(config: "Config") -> Iterator[Preparation]:
    """`prepare_apart` in a process beside this one, which may go on and have threads; it ends with the block.

    Called while the process has one thread.
    """
    if _fingerprint(config) in _prepared(config.cache_dir / MARKER):
        yield Preparation(None)
        return
    import mocapd.session.session  # noqa: F401  all that the processes need, imported once for them

    child = multiprocessing.get_context("fork").Process(target=_work, args=(prepare_apart, config))
    child.start()
    try:
        yield Preparation(child)
    finally:
        child.kill()
        child.join()


def prepare_apart(config: "Config") -> None:
    """Make the caches that this code and tracker need, in processes of their own, unless that was done before.

    A failure is not told here: the caller comes upon it again, and tells it. What ends the
    caller ends the work too; what is half made is made anew next time. Called while the process has
    one thread.
    """
    marker = config.cache_dir / MARKER
    want = _fingerprint(config)
    done = _prepared(marker)
    if want in done:
        return
    import mocapd.session.session  # noqa: F401  see above
    from mocapd.capture.kinds.source_kinds import is_simulated

    # what takes longest side by side, then what needs both; with real cameras `_open` is alone, as
    # it tells at once what is wrong with them
    simulated = any(is_simulated(camera.source) for camera in config.camera)
    first = (_make_film, _make_database) if simulated else ()
    if _all_end_well(config, first) and _all_end_well(config, (_open,)):
        _remember(marker, [*done[1 - REMEMBERED :], want])


def _prepared(marker: Path) -> list[str]:
    """What is remembered; nothing of it where that cannot be read, so all is prepared once more."""
    try:
        return read_text(marker, _MOST_BYTES).split()
    except InputError:
        return []


def _remember(marker: Path, done: Sequence[str]) -> None:
    try:
        with whole_file(marker) as partial:
            partial.write_text("\n".join(done) + "\n", "utf-8")
    except OSError as error:
        _log.warning(
            "%s cannot be written (%s): the next start prepares everything again",
            *(marker, error.strerror),
        )


@contextmanager
def database_beside(config: "Config") -> Iterator[None]:
    """Makes the pose database, if there is none, in a process beside this one; it ends with the block.

    A setup's first steps take longer than that, its later ones need it: they wait for what is under
    way. What this code has made or found before is not looked at again while the file is there: should it be
    damaged, who needs it makes it anew. Called while the process has one thread. A failure is told by whoever
    needs it.
    """
    from mocapd.trackers.registry import has_caches

    made = _fingerprint(config, _DATABASE) in _prepared(config.cache_dir / MARKER)
    if made and has_caches(config.tracker.name, config.cache_dir):
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


def _work(work: Callable[["Config"], None], config: "Config") -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    assert parent.pid is not None
    end_with_parent(parent.pid, signal.SIGKILL)
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    try:
        work(config)
    except MocapdError:
        os._exit(1)


def _make_film(config: "Config") -> None:
    """What the simulated webcams show; its bar gives way to the database's, which takes longer."""
    from mocapd.capture.kinds.source_kinds import open_origin, origin_of

    for origin in {origin_of(camera.source) for camera in config.camera}:
        open_origin(origin, config.cache_dir, lambda *_: None)


def _make_database(config: "Config") -> None:
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.session.tracker_setup import make_caches

    with ProgressBars() as progress:
        progress("pose database", 0, 100)  # something to see while its maker is compiled
        make_caches(config.tracker.name, config.cache_dir, progress)


def _make_database_quietly(config: "Config") -> None:
    from mocapd.session.tracker_setup import make_caches

    os.nice(5)  # the board is looked for meanwhile
    make_caches(config.tracker.name, config.cache_dir, lambda *_: None)
    marker = config.cache_dir / MARKER
    want, done = _fingerprint(config, _DATABASE), _prepared(marker)
    if want not in done:
        _remember(marker, [*done[1 - REMEMBERED :], want])


def _open(config: "Config") -> None:
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.session.session import open_session

    with ProgressBars() as progress:
        progress.begin("preparing the tracker")
        open_session(config, progress)


def _fingerprint(config: "Config", what: str = "") -> str:
    """Of everything that compiled code and caches depend on; `what`: of them, all when empty."""
    package = Path(mocapd.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        stat = path.stat()
        digest.update(f"{path} {stat.st_size} {stat.st_mtime_ns}\n".encode())
    tracker = config.tracker
    digest.update(f"{platform.python_version()} {version('numba')} {tracker.name}{what}".encode())
    return digest.hexdigest()
