"""The page of a running service: served from the first body on, across sessions."""

import logging
import time
from typing import TYPE_CHECKING

from mocapd.app.daemon.patient_imports import PatientImports
from mocapd.app.terminal.own_command import own_command
from mocapd.errors import MocapdError
from mocapd.user_command import user_command

if TYPE_CHECKING:
    from mocapd.service.service import Service, Snapshot
    from mocapd.web.server import WebServer
    from mocapd.wizard.hosts.daemon_host import DaemonHost

FIRST_BODY_TIMEOUT_S = 5.0  # the page waits so long for the first body, which it would delay [s]
HANG_UP_S = 0.5  # for browsers, at the end [s]
SHOWN_S = 2.0  # a finished setup stays visible so long [s]

_log = logging.getLogger(__name__)


class DaemonPage:
    """For the main thread."""

    def __init__(self, service: "Service") -> None:
        self._service = service
        self._host: DaemonHost | None = None
        self._server: WebServer | None = None
        self._began_s = time.monotonic()
        self._saved_s: float | None = None

    def on_tick(self, snapshot: "Snapshot") -> None:
        """Called several times a second."""
        if self._host is None:
            waited_s = time.monotonic() - self._began_s
            if snapshot.metrics.published > 0 or waited_s > FIRST_BODY_TIMEOUT_S:
                self._begin()
            return
        self._host.beat()
        if self._host.saved.is_set() and self._saved_s is None:
            self._saved_s = time.monotonic()
            if not self._runs_on_saved():
                _log.info("a calibration is saved; this daemon goes on with what it was started on")

    def take_saved(self) -> bool:
        """True once after a setup has saved the service's calibration and has shown so."""
        if self._saved_s is None or time.monotonic() - self._saved_s < SHOWN_S:
            return False
        if self._host is not None:
            self._host.saved.clear()
        self._saved_s = None
        return self._runs_on_saved()

    def rest(self) -> None:
        """Ends a running setup and refuses new ones, before a change of the session."""
        if self._host is not None:
            self._host.rest()

    def resume(self) -> None:
        """Permits setups again."""
        if self._host is not None:
            self._host.resume()

    def let_go(self) -> None:
        """First phase of stopping; never blocks for long."""
        if self._host is not None:
            self._host.close()
        if self._server is not None:
            self._server.let_go()
        self.rest()

    def close(self) -> None:
        """Stops the server."""
        if self._server is not None:
            self._server.stop(HANG_UP_S)

    def _begin(self) -> None:
        # imported here: it takes a third of a second, which would delay the first body
        with PatientImports(self._service.idle):
            from mocapd.config.runtime_folder import runtime_folder
            from mocapd.web.runtime_file import Place
            from mocapd.web.server import WebServer
            from mocapd.wizard.hosts.daemon_host import DaemonHost

        service, config = self._service, self._service.config
        self._host = DaemonHost(service)
        place = Place(runtime_folder(config.state_dir), config.state_dir, service.instance)
        server = WebServer(self._host, config.web, service.died, place)
        try:
            server.start()
        except MocapdError as error:  # the daemon runs without a page
            _log.warning("no page: %s", error)
            return
        self._server = server
        command = user_command("calibrate", own_command())
        _log.info("`%s` opens the page with the live view and the setup", command)

    def _runs_on_saved(self) -> bool:
        """True if a new session would use the saved calibration."""
        from mocapd.calibration.calibration_file import calibration_path
        from mocapd.wizard.hosts.daemon_host import state_dir_of

        config = self._service.config
        if config.rig is None:
            return state_dir_of(config, self._service.session) == config.state_dir
        saved = calibration_path(config.state_dir)
        return calibration_path(config.rig).resolve() == saved.resolve()
