"""The demo: a daemon of its own on simulated cameras, and its stream."""

import shutil
import socket
import subprocess
import time
from importlib.util import find_spec
from pathlib import Path

from goalkeeper.streams.daemon_progress import DaemonProgress
from goalkeeper.streams.demo_script import demo_scenario, scenario_toml
from goalkeeper.streams.live_stream import LiveStream
from goalkeeper.streams.sighting import Sighting, StreamState
from mocapd.child_process import child_command
from mocapd.client import Link
from mocapd.errors import CannotCreateError, UnavailableError
from mocapd.whole_file import whole_file

_INSTANCE = "goalkeeper-demo"
_END_S = 5.0  # a daemon ends within two
DAEMON = "from mocapd.cli.main import main; main()"
_OTHER = (
    "import os; os.execv({0!r}, [{0!r}, *sys.argv[1:]])"  # it keeps the signal of its parent's end
)


def daemon_program() -> str:
    """Python statements that run `mocapd`: of this environment, else the command that is on the PATH. Raises
    UnavailableError where there is none."""
    if find_spec("mocapd.cli") is not None:
        return DAEMON
    command = shutil.which("mocapd")
    if command is None:
        raise UnavailableError(
            "the demo needs mocapd itself, and the small install is here alone",
            "goalkeeper --demo",
            "install mocapd (its README says how), or start `goalkeeper` while a daemon runs",
        )
    return _OTHER.format(command)


class DemoStream:
    """Starts the daemon, and ends it with `close`; it also ends when this process ends. The first start draws what
    the cameras see and compiles the tracker: a minute or two, of which `state` gives the share and the time."""

    def __init__(self, folder: Path, daemon: str | None = None) -> None:
        """folder: where the scenario is written; daemon: Python statements that run `mocapd`. Called by the main
        thread. Raises CannotCreateError, UnavailableError."""
        program = daemon_program() if daemon is None else daemon
        scenario = folder / "goalkeeper.toml"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with whole_file(scenario) as partial:
                partial.write_text(scenario_toml(demo_scenario()))
        except OSError as error:
            raise CannotCreateError(
                f"cannot be written ({error.strerror})", str(scenario), "make room there"
            ) from None
        port = _free_port()
        self._began_s = time.monotonic()
        self.process = subprocess.Popen(
            child_command(
                program,
                "run",
                *("--capture", f"sim:{scenario}", "--instance", _INSTANCE),
                *("--set", f"zenoh.port={port}", "--set", "zenoh.enabled=true"),
                *("--set", "osc.enabled=false", "--set", "web.enabled=false"),
            ),
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
        )
        assert self.process.stderr is not None
        self._progress = DaemonProgress(self.process.stderr)
        self._live = LiveStream(Link(f"tcp/127.0.0.1:{port}", _INSTANCE))

    def poll(self, now_s: float) -> list[Sighting]:
        """The newest frame, when there is one."""
        return self._live.poll(now_s)

    def state(self) -> StreamState:
        """Whether frames come, and the daemon lives."""
        code = self.process.poll()
        if code is not None:
            return StreamState(f"the demo's daemon has ended (exit code {code})", ended=True)
        if not self._live.has_heard:
            return StreamState(self._progress.text(time.monotonic() - self._began_s))
        return self._live.state()

    def close(self) -> None:
        """End the daemon."""
        self._live.close()
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(_END_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self._progress.close()


def _free_port() -> int:
    """A TCP port of the loopback that nobody has just now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
