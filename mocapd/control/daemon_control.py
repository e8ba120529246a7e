"""Executes the requests of a daemon's control socket."""

import logging
from pathlib import Path
from typing import assert_never

from mocapd.config.sections import Config
from mocapd.control.control_messages import Recentered, Reloaded, StatusReport, Verb
from mocapd.control.control_socket import ControlSocket
from mocapd.control.last_trouble import LastTrouble
from mocapd.control.reloads import Reloads
from mocapd.control.status_report import starting_report, status_report
from mocapd.errors import MocapdError, UnavailableError
from mocapd.outputs.output_table import OUTPUTS
from mocapd.service.open_outputs import OpenOutputs
from mocapd.service.service import Service, Snapshot

_log = logging.getLogger(__name__)


class DaemonControl:
    """A context manager and LoopHook (see main_loop). The socket exists from `open` on, while the first session is still
    prepared. `path`: of the socket."""

    def __init__(
        self, path: Path, config: Config, outputs: OpenOutputs, trouble: LastTrouble
    ) -> None:
        self._config, self._outputs, self._trouble = config, outputs, trouble
        self._socket = ControlSocket(path, self._answer, self._died)
        self._service: Service | None = None
        self._preparing = ""
        self._reloads = Reloads()
        self._death: BaseException | None = None

    def __enter__(self) -> "DaemonControl":
        return self

    def __exit__(self, *_: object) -> None:
        self.let_go()

    def open(self) -> None:
        """Opens the socket, once the outputs are open."""
        try:
            self._socket.open()
        except MocapdError as error:  # tracking does not need it
            _log.warning("`mocapd status` will not find this daemon: %s", error)

    def preparing(self, text: str) -> None:
        """Sets the progress of preparations, for users; empty when they are over."""
        self._preparing = text

    def what_is_prepared(self) -> str:
        """The last text of `preparing`."""
        return self._preparing

    def attach(self, service: Service, reloads: Reloads) -> None:
        """Registers the service once there is a session."""
        self._reloads, self._service = reloads, service
        if self._death is not None:
            service.died(self._death)

    def on_tick(self, _snapshot: Snapshot) -> None:
        """See LoopHook."""

    def let_go(self) -> None:
        self._socket.close()

    def _died(self, error: BaseException) -> None:
        """Called in a thread of the socket."""
        self._death = error
        if self._service is not None:
            self._service.died(error)

    def _answer(self, verb: Verb) -> StatusReport | Recentered | Reloaded:
        """Called in a thread of the socket. Raises MocapdError."""
        service = self._service
        if service is None:
            if verb != "status":
                raise _starting()
            return starting_report(
                self._config, self._outputs, self._trouble.newest, self._preparing
            )
        match verb:
            case "status":
                return status_report(service, self._trouble.newest, self._preparing)
            case "recenter":
                facing, outputs = service.recenter(), service.snapshot().outputs
                informed = [n for n, entry in OUTPUTS.items() if entry.uses_facing and n in outputs]
                return Recentered(facing.yaw_deg, tuple(informed))
            case "reload":
                return self._reloads.ask()
            case other:
                assert_never(other)


def _starting() -> UnavailableError:
    return UnavailableError("it is still starting", "the daemon", "see `mocapd status`")
