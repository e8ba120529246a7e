"""The end of a Zenoh session, whatever those who are connected do."""

import logging
import threading
from contextlib import ExitStack

import zenoh

from mocapd.bus.zenoh_limits import CLOSE_S

_log = logging.getLogger(__name__)


def close_soon(opened: ExitStack, wait_s: float = CLOSE_S) -> None:
    """Close what was opened, and wait for it no longer than that [s].

    A program that is connected and does not read, such as a game in a debugger, holds Zenoh up for
    10 s. Meanwhile the port is free already; the connections end with the process or those 10 s.
    """
    # no daemon thread: one that comes back from Zenoh while the interpreter ends aborts the process
    closing = threading.Thread(target=_close, args=(opened.pop_all(),), name="zenoh-close")
    closing.start()
    closing.join(wait_s)
    if closing.is_alive():
        _log.info("a program on Zenoh does not read; ending without waiting for it")


def _close(opened: ExitStack) -> None:
    try:
        opened.close()
    except zenoh.ZError as error:
        # past the sentence itself Zenoh appends the place in its own source
        _log.info("not everybody on Zenoh took the end: %s", str(error).partition(" at /")[0])
