"""Replaces the session of a running service: prepares the next one in a thread, then swaps them."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from mocapd.app.daemon.daemon_page import DaemonPage
from mocapd.app.daemon.heap import give_back
from mocapd.app.daemon.main_loop import Signals
from mocapd.app.daemon.notifier import Notifier
from mocapd.app.daemon.unsafe_settings import unsafe_settings
from mocapd.app.terminal.logs import set_up_logs
from mocapd.config.effective import Effective
from mocapd.config.sections import Config
from mocapd.control.control_messages import Reloaded
from mocapd.control.reloads import Reloads
from mocapd.errors import MocapdError
from mocapd.service.service import Service, Snapshot
from mocapd.session.session import Session, open_session

_log = logging.getLogger(__name__)

SAVED = "a calibration was saved"
ASKED = "reload requested"
PREPARED = "everything is prepared"


# fixed while the process runs: outputs and page are open, and clients find them by name and folder
_FIXED = ("instance", "cache_dir", "state_dir", "prediction", "web")


def apply_live_changes(running: Config, wanted: Config) -> tuple[Config, tuple[str, ...]]:
    """The wanted configuration with the fixed values of the running one, and the names of changed keys and sections that
    need a restart."""
    fixed = {name: getattr(running, name) for name in _FIXED}
    waiting = [name for name in _FIXED if getattr(wanted, name) != fixed[name]]
    names = dict.fromkeys((*running.outputs, *wanted.outputs))
    waiting += [name for name in names if running.outputs.get(name) != wanted.outputs.get(name)]
    return replace(wanted, **fixed, outputs=running.outputs), tuple(waiting)


@dataclass(frozen=True, slots=True, eq=False)
class _Ready:
    """The next session; `waiting`: changes of the configuration that need a restart."""

    effective: Effective
    waiting: tuple[str, ...]
    session: Session


class _Preparation:
    """One preparation, in a thread of its own; the process does not wait for it at its end.

    Reads configuration and calibration again, builds the tracker and warms it up: seconds, in which the current session
    goes on.
    """

    def __init__(self, service: Service, read: Callable[[], Effective]) -> None:
        self._service, self._read = service, read
        self.ready: _Ready | None = None
        self.refused: MocapdError | None = None
        self._thread = threading.Thread(target=self._run, name="next-session")
        self._thread.start()

    @property
    def over(self) -> bool:
        """True after its end, successful or not."""
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            effective = self._read()
            config, waiting = apply_live_changes(self._service.config, effective.config)
            session = open_session(config, _quiet)
        except MocapdError as error:
            self.refused = error
            return
        changed = Effective(config, effective.settings, effective.file)
        self.ready = _Ready(changed, waiting, session)


class SessionChange:
    """See LoopHook. Changes the session after a setup has saved its calibration, or on request by a signal or by
    `reloads`. `page`: None without one."""

    def __init__(
        self,
        service: Service,
        read: Callable[[], Effective],
        signals: Signals,
        page: DaemonPage | None,
        notifier: Notifier,
    ) -> None:
        """read: reads the configuration from its sources."""
        self._service, self._read, self._signals, self._page = service, read, signals, page
        self.reloads = Reloads()
        self._notifier = notifier  # reports the begin and end of a reload
        self._preparation: _Preparation | None = None
        self._why = self._wish = ""

    def on_tick(self, snapshot: Snapshot) -> None:
        if self._page is not None:
            self._page.on_tick(snapshot)
        if self._preparation is None:
            self._begin_if_asked()
        elif self._preparation.over:
            preparation, self._preparation = self._preparation, None
            if preparation.ready is not None:
                self._take(preparation.ready)
            elif preparation.refused is not None:
                _log.warning(
                    "%s, but the session goes on as it was: %s", self._why, preparation.refused
                )
                self.reloads.settle(preparation.refused)
            if self._why == ASKED:
                self._notifier.end_reload()
            if self._page is not None:
                self._page.resume()

    def ask(self, why: str) -> None:
        """Requests another session, after a running preparation; call in the loop's thread."""
        self._wish = why

    def let_go(self) -> None:
        self.reloads.close()
        if self._page is not None:
            self._page.let_go()

    def _begin_if_asked(self) -> None:
        if self._page is not None and self._page.take_saved():
            # the setup's tracker ends before another one is built
            self._page.rest()
            self._begin(SAVED)
        elif self._signals.take_reload() | self.reloads.take():
            self._notifier.reloading()
            self._begin(ASKED)
        elif self._wish:
            why, self._wish = self._wish, ""
            self._begin(why)

    def _begin(self, why: str) -> None:
        self._why = why
        _log.info("%s: preparing another session while this one goes on", why)
        self._preparation = _Preparation(self._service, self._read)

    def _take(self, ready: _Ready) -> None:
        config = ready.effective.config
        if config.log_level != self._service.config.log_level:
            set_up_logs(config.log_level)
        for line in unsafe_settings(ready.effective):
            _log.warning("unsafe: %s", line)
        if ready.waiting:
            _log.warning("changed, but only for the next start: %s", ", ".join(ready.waiting))
        if self._page is not None:
            self._page.rest()
        began_s = time.monotonic()
        self._service.replace(config, ready.session)
        took_s = time.monotonic() - began_s
        give_back()
        _log.info("%s: taken up, within %.2f s", self._why, took_s)
        self.reloads.settle(Reloaded(took_s, ready.waiting))


def _quiet(_what: str, _done: int, _total: int) -> None:
    """No progress bars, which would disturb the status line."""
