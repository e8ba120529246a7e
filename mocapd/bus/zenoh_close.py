"""Closes a Zenoh session within a time limit, whatever its peers do."""

import logging
import threading
from contextlib import ExitStack

import zenoh

from mocapd.bus.zenoh_limits import CLOSE_S

_log = logging.getLogger(__name__)


def close_soon(opened: ExitStack, wait_s: float = CLOSE_S) -> None:
    """Closes the session in a thread, and waits at most `wait_s` [s].

    A connected program that does not read, such as a game in a debugger, delays Zenoh for 10 s. The port is free
    already; the connections end after the 10 s or with the process.
    """
    # no daemon thread: its return from Zenoh during the interpreter's exit would abort the process
    closing = threading.Thread(target=_close, args=(opened.pop_all(),), name="zenoh-close")
    closing.start()
    closing.join(wait_s)
    if closing.is_alive():
        _log.info("a program on Zenoh does not read; ending without waiting for it")


def _close(opened: ExitStack) -> None:
    try:
        opened.close()
    except zenoh.ZError as error:
        # Zenoh appends its source location
        _log.info("a peer on Zenoh did not accept the close: %s", str(error).partition(" at /")[0])
