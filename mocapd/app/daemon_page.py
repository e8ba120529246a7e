"""The page of a running daemon: served once bodies come, over one daemon after another."""

import logging
import time
from typing import TYPE_CHECKING

from mocapd.config.sections import Config
from mocapd.errors import MocapdError

if TYPE_CHECKING:
    from mocapd.service.daemon import Daemon, Snapshot
    from mocapd.session.session import Session
    from mocapd.web.server import WebServer
    from mocapd.wizard.hosts.daemon_host import DaemonHost

PATIENCE_S = 5.0  # that the page waits for the first body, so as not to delay it [s]
HANG_UP_S = 0.5  # for browsers, at the end [s]
SHOWN_S = 2.0  # a saved setup is shown as saved before the cameras are opened anew [s]

_log = logging.getLogger(__name__)


class DaemonPage:
    """Used by the main thread, apart from what its host's own words say."""

    def __init__(self, config: Config) -> None:
        self._config = config
        self._host: DaemonHost | None = None
        self._server: WebServer | None = None
        self._run: tuple[Daemon, Session] | None = None
        self._began_s = 0.0
        self._saved_s: float | None = None

    def serve(self, daemon: "Daemon", session: "Session") -> None:
        """This daemon is about to run."""
        self._run, self._began_s = (daemon, session), time.monotonic()
        self._saved_s = None
        if self._host is not None:
            self._host.serve(daemon, session)

    def beat(self, snapshot: "Snapshot") -> bool:
        """See Beside: to be made anew some time after a setup has saved what this daemon runs on."""
        if self._host is None:
            waited_s = time.monotonic() - self._began_s
            if snapshot.metrics.published > 0 or waited_s > PATIENCE_S:
                self._begin()
            return False
        self._host.beat()
        if self._host.saved.is_set() and self._saved_s is None:
            self._saved_s = time.monotonic()
            if not self._runs_on_saved():
                _log.info("a calibration is saved; this daemon goes on with what it was started on")
        if self._saved_s is None or time.monotonic() - self._saved_s < SHOWN_S:
            return False
        return self._runs_on_saved()

    def let_go(self, anew: bool) -> None:
        """See Beside."""
        if self._server is not None and not anew:
            self._server.let_go()
        if self._host is not None:
            self._host.rest()

    def close(self) -> None:
        """For ever."""
        if self._server is not None:
            self._server.stop(HANG_UP_S)

    def _begin(self) -> None:
        # here, as it takes a third of a second that nobody waits for now
        from mocapd.web.runtime_file import Place, runtime_folder
        from mocapd.web.server import WebServer
        from mocapd.wizard.hosts.daemon_host import DaemonHost

        assert self._run is not None
        daemon, session = self._run
        self._host = DaemonHost(self._config)
        self._host.serve(daemon, session)
        state_dir = self._config.state_dir
        place = Place(runtime_folder(state_dir), state_dir, daemon.instance)
        server = WebServer(self._host, self._config.web, self._died, place)
        try:
            server.start()
        except MocapdError as error:  # bodies are what the daemon is for: it goes on without a page
            _log.warning("no page: %s", error)
            return
        self._server = server
        _log.info("`mocapd calibrate` opens the page with the live view and the setup")

    def _died(self, error: BaseException) -> None:
        """The page died of what nobody expected: so must the daemon that runs now."""
        assert self._run is not None
        self._run[0].died(error)

    def _runs_on_saved(self) -> bool:
        """Whether a daemon that is made now takes up what was saved."""
        from mocapd.calibration.calibration_file import calibration_path
        from mocapd.wizard.hosts.daemon_host import state_dir_of

        assert self._run is not None
        if self._config.rig is None:
            return state_dir_of(self._config, self._run[1]) == self._config.state_dir
        saved = calibration_path(self._config.state_dir)
        return calibration_path(self._config.rig).resolve() == saved.resolve()
