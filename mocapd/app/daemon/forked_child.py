"""A forked child process that ends with a block of its parent, and with the parent itself."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.process import BaseProcess

from mocapd.child_process import end_with_parent
from mocapd.errors import MocapdError


@contextmanager
def forked(work: Callable[..., None], *arguments: object) -> Iterator[BaseProcess]:
    """Runs `work` in a child, whose exit code is 0 if it succeeded; a MocapdError is silent, 1.

    Call it while the process has one thread.
    """
    child = multiprocessing.get_context("fork").Process(target=_run, args=(work, *arguments))
    child.start()
    try:
        yield child
    finally:
        child.kill()
        child.join()


def _run(work: Callable[..., None], *arguments: object) -> None:
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
