"""A daemon on simulated cameras with a saved calibration, as after a first set-up, and a game that never leaves it."""

import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import msgspec
import numpy as np
import zenoh
from websockets.sync.client import connect
from websockets.typing import Origin

from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.sim.film import load_film
from mocapd.sim.scenario import load_scenario
from mocapd.types import Floats
from mocapd.web.runtime_file import Running, begin_setup, running
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality
from mocapd.wizard.saving import save_draft
from tests.cli.mocapd_process import COMMAND
from tests.cli.own_time import waits_of
from tests.e2e.test_daemon import SCENARIO
from tests.outputs.frames import free_port

PATIENCE_S = 600.0  # a first start on a busy machine compiles for minutes
INSTANCE = "replaced"


def write_calibration(folder: Path, cache_dir: Path, stature_m: float) -> None:
    """What a set-up on the scenario's cameras would have saved in `folder`/state."""
    scenario = load_scenario(SCENARIO)
    setup = load_film(scenario, cache_dir).setup
    cameras = tuple(
        DraftCamera(one.name, f"sim:{SCENARIO}#{one.name}", one.size_px, scenario.fps_hz)
        for one in setup.rig.cameras
    )
    draft = Draft(
        cameras=cameras,
        rig=setup.rig,
        extrinsics_quality=ExtrinsicsQuality("board", 0.2, {one.id: 0.2 for one in cameras}, 0.5),
        floor_known=True,
        colours={name: DraftColours(one, np.eye(3)) for name, one in setup.scribbles.items()},
        stature_m=stature_m,
    )
    save_draft(draft, folder / "state")


def wait_until(condition: Callable[[], object], what: str) -> None:
    until_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until_s, what
        time.sleep(0.01)


@dataclass(frozen=True)
class Heard:
    """One frame as it came: its number, when it was published, whether somebody was seen, and how long the
    daemon's threads have waited for a processor by then [s]."""

    seq: int
    published_ns: int
    tracking: str
    waited_s: float


class Game:
    """Connects once, and keeps what comes. `departures`: that the daemon's token went."""

    def __init__(self, daemon: "Daemon") -> None:
        self._waited_s = waits_of(daemon.process.pid)
        config = {
            "mode": "client",
            "connect": {"endpoints": [f"tcp/127.0.0.1:{daemon.port}"], "timeout_ms": 5000},
            "scouting": {"multicast": {"enabled": False}},
        }
        self.session = zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
        self.heard: list[Heard] = []
        self.rests: list[dict[str, Any]] = []
        self.departures = 0
        self._opened = ExitStack()
        self._declare("skeleton/0", self._hear)
        self._declare("rest_skeleton/0", self.rests.append)
        handler = zenoh.handlers.Callback(self._token, indirect=False)
        token = f"mocapd/v1/{INSTANCE}/alive"
        self._opened.enter_context(
            self.session.liveliness().declare_subscriber(token, handler, history=True)
        )
        self.peers = self.connected()

    def _declare(self, key: str, take: Callable[[dict[str, Any]], None]) -> None:
        def arrived(sample: zenoh.Sample) -> None:
            take(msgspec.msgpack.decode(sample.payload.to_bytes()))

        handler = zenoh.handlers.Callback(arrived, indirect=False)
        key = f"mocapd/v1/{INSTANCE}/{key}"
        self._opened.enter_context(self.session.declare_subscriber(key, handler))

    def _hear(self, message: dict[str, Any]) -> None:
        numbers = message["seq"], message["publish_monotonic_ns"]
        self.heard.append(Heard(*numbers, message["tracking"], self._waited_s()))

    def _token(self, sample: zenoh.Sample) -> None:
        self.departures += sample.kind == zenoh.SampleKind.DELETE

    def close(self) -> None:
        self._opened.close()
        self.session.close()  # type: ignore[no-untyped-call]

    def connected(self) -> list[str]:
        """With whom it is connected, by their ids: other ones after a reconnect."""
        return [
            *map(str, self.session.info.peers_zid()),
            *map(str, self.session.info.routers_zid()),
        ]

    def ask(self, key: str) -> dict[str, Any]:
        """State, as a late joiner asks for it."""
        (reply,) = self.session.get(f"mocapd/v1/{INSTANCE}/{key}", timeout=5.0)
        assert reply.ok is not None
        state: dict[str, Any] = msgspec.msgpack.decode(reply.ok.payload.to_bytes())
        return state

    def is_live(self) -> bool:
        return bool(self.heard) and self.heard[-1].tracking == "live"

    def gap_s(self, since: int) -> float:
        """The longest time between frames from number `since` in the list on [s]."""
        return float(self._gaps_s(since).max())

    def own_gap_s(self, since: int) -> float:
        """The same without what the daemon waited for a processor from the frame before to the frame after."""
        waited_s = np.array([one.waited_s for one in self.heard[since:]])
        waited_s = np.concatenate([waited_s[:1], waited_s, waited_s[-1:]])
        return float((self._gaps_s(since) - (waited_s[3:] - waited_s[:-3])).max())

    def _gaps_s(self, since: int) -> Floats:
        return np.diff([one.published_ns for one in self.heard[since:]]) / 1e9


class Daemon:
    """`mocapd run` on that calibration, configured by a file that the test may change."""

    def __init__(self, env: Mapping[str, str], folder: Path) -> None:
        self.folder, self.port = folder, free_port()
        runtime = folder / "runtime"
        runtime.mkdir(mode=0o700)
        self.configure()
        self._log = (folder / "log").open("wb")
        self.env = {**env, "XDG_RUNTIME_DIR": str(runtime)}
        words = ("run", "--config", str(folder / "config.toml"))
        self.process = subprocess.Popen(
            [*COMMAND, *words],
            env=self.env,
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=self._log,
            text=True,
        )

    def configure(self, *lines: str) -> None:
        """Write the config file: what every one has, and these lines."""
        always = (
            f"instance = '{INSTANCE}'",
            "state_dir = 'state'",
            f"zenoh.port = {self.port}",
            "osc.enabled = false",
            "tracker.name = 'shirt'",
        )
        (self.folder / "config.toml").write_text("\n".join((*always, *lines)))

    def assume_stature(self, stature_m: float) -> None:
        """Into the saved calibration, as who measured again would."""
        path = self.folder / "state" / FILE_NAME
        lines = path.read_text().splitlines()
        lines = [f"stature_m = {stature_m}" if s.startswith("stature_m") else s for s in lines]
        path.write_text("\n".join(lines) + "\n")

    @property
    def log(self) -> str:
        return (self.folder / "log").read_text()

    def told(self, text: str, times: int = 1) -> None:
        """Wait until it has logged that."""
        wait_until(lambda: self.log.count(text) >= times or self.process.poll() is not None, text)
        assert self.log.count(text) >= times, self.log

    def page(self) -> Running:
        """Its page, as soon as it is announced."""
        folder = self.folder / "runtime" / "mocapd"
        wait_until(lambda: running(folder) or self.process.poll() is not None, "a page")
        assert self.process.poll() is None, self.log
        return running(folder)[0]

    def reload(self) -> None:
        self.process.send_signal(signal.SIGHUP)

    def rss_mb(self) -> float:
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGESIZE") / 1e6

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        self._log.close()


def save_in_the_wizard(page: Running, stature_m: float) -> None:
    """What a person does who is of another height: say so in the step Body, check, and save."""
    begin_setup(page.url, "body")
    parts = urlsplit(page.url)
    address = parts._replace(scheme="ws", path="/ws").geturl()
    origin = Origin(f"http://{parts.netloc}")
    with connect(address, origin=origin, proxy=None, open_timeout=PATIENCE_S) as socket_:
        view: dict[str, Any] = {}

        def wait(until: Callable[[dict[str, Any]], bool]) -> None:
            nonlocal view
            while not view or not until(view):
                view = json.loads(socket_.recv(PATIENCE_S))

        def do(verb: str, **args: object) -> None:
            socket_.send(json.dumps({"verb": verb, "args": args}))

        do("take_over")
        wait(lambda view: view["driver"] and view.get("step") == "body")
        do("stature", m=stature_m)
        do("go", step="check")
        wait(lambda view: view["step"] == "check" and view["view"]["details"]["phase"] == "judged")
        do("save")
        wait(lambda view: view["saved"])
