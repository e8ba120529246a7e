"""Warns of another daemon with the same state folder, where a setup of one replaces the calibration of the other."""

import logging
import os
import threading

from mocapd.config.sections import Config
from mocapd.control.target_process import find_daemons
from mocapd.service.service import Snapshot

_log = logging.getLogger(__name__)


class SharedState:
    """See LoopHook. Looks once, in a thread: a daemon that hangs answers late."""

    def __init__(self, config: Config) -> None:
        self._thread = threading.Thread(target=warn_if_shared, args=(config,), daemon=True)

    def on_tick(self, _snapshot: Snapshot) -> None:
        """See LoopHook."""
        if self._thread.ident is None:
            self._thread.start()

    def let_go(self) -> None:
        """See LoopHook."""


def warn_if_shared(config: Config) -> None:
    """Logs a warning for each other daemon of this state folder."""
    state_dir = str(config.state_dir.resolve())
    for daemon in find_daemons(config).daemons:
        if daemon.state_dir == state_dir and daemon.status.pid != os.getpid():
            _log.warning(
                "%s: is the state folder of the daemon %r (pid %d) too: a setup of one replaces the calibration of the"
                " other -- give each its own state_dir",
                *(state_dir, daemon.instance, daemon.status.pid),
            )
