"""The first start in a process of its own: compiling and building takes memory that only its end gives back."""

import hashlib
import multiprocessing
import os
import platform
import signal
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import mocapd
from mocapd.errors import MocapdError

if TYPE_CHECKING:
    from mocapd.config_sections import Config

MARKER = "prepared"  # in the cache folder: what was prepared for, one a line
REMEMBERED = 8


def prepare_apart(config: "Config") -> None:
    """Make the caches that this code and tracker need, unless that was done before.

    A failure is not told here: the caller comes upon it again, and tells it. A signal that ends the
    caller ends the work too; what is half made is made anew next time. Called while the process has
    one thread.
    """
    marker = config.cache_dir / MARKER
    want = _fingerprint(config)
    done = marker.read_text().split() if marker.is_file() else []
    if want in done:
        return
    child = multiprocessing.get_context("fork").Process(target=_prepare, args=(config,))
    child.start()
    try:
        child.join()
    finally:
        child.kill()
    if child.exitcode == 0:
        fresh = marker.with_suffix(".new")
        fresh.write_text("\n".join([*done[1 - REMEMBERED :], want]) + "\n")
        fresh.replace(marker)


def _prepare(config: "Config") -> None:
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, signal.SIG_DFL)

    from mocapd.cli.progress import ProgressBars
    from mocapd.session import open_session

    try:
        with ProgressBars() as progress:
            open_session(config, progress)
    except MocapdError:
        os._exit(1)


def _fingerprint(config: "Config") -> str:
    """Of everything that compiled code and caches depend on."""
    package = Path(mocapd.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        stat = path.stat()
        digest.update(f"{path} {stat.st_size} {stat.st_mtime_ns}\n".encode())
    tracker = config.tracker
    digest.update(
        f"{platform.python_version()} {version('numba')} {tracker.name} {tracker.variant}".encode()
    )
    return digest.hexdigest()
