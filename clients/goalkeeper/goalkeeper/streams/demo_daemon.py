"""The demo: a daemon of its own on simulated cameras, and its stream."""

import socket
import subprocess
import sys
from pathlib import Path

from goalkeeper.streams.demo_script import demo_scenario, scenario_toml
from goalkeeper.streams.live_stream import LiveStream
from goalkeeper.streams.sighting import Sighting, StreamState
from mocapd.client import Link
from mocapd.errors import CannotCreateError
from mocapd.whole_file import whole_file

_INSTANCE = "goalkeeper-demo"
_END_S = 5.0  # a daemon ends within two
_MAIN = "from mocapd.cli.main import main; main()"


class DemoStream:
    """Starts the daemon, and ends it with `close`. The first start draws what the cameras see: a minute or two."""

    def __init__(self, folder: Path) -> None:
        """folder: where the scenario is written. Raises CannotCreateError."""
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
        self._daemon = subprocess.Popen(
            [
                *(sys.executable, "-c", _MAIN, "run"),
                *("--capture", f"sim:{scenario}", "--instance", _INSTANCE),
                *("--set", f"zenoh.port={port}", "--set", "zenoh.enabled=true"),
                *("--set", "osc.enabled=false", "--set", "web.enabled=false"),
            ],
            stdin=subprocess.DEVNULL,
        )
        self._live = LiveStream(Link(f"tcp/127.0.0.1:{port}", _INSTANCE))

    def poll(self, now_s: float) -> list[Sighting]:
        """The newest frame, when there is one."""
        return self._live.poll(now_s)

    def state(self) -> StreamState:
        """Whether frames come, and the daemon lives."""
        code = self._daemon.poll()
        if code is not None:
            return StreamState(f"the demo's daemon has ended (exit code {code})", ended=True)
        state = self._live.state()
        if state.trouble.startswith("no mocapd"):
            return StreamState("the demo's cameras are being prepared: see the terminal")
        return state

    def close(self) -> None:
        """End the daemon."""
        self._live.close()
        if self._daemon.poll() is None:
            self._daemon.terminate()
            try:
                self._daemon.wait(_END_S)
            except subprocess.TimeoutExpired:
                self._daemon.kill()
                self._daemon.wait()


def _free_port() -> int:
    """A TCP port of the loopback that nobody has just now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
