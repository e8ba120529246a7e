"""The daemon that faults are done to: `mocapd run` in a home of its own, and all that it sends and tells."""

import os
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil
import zenoh
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from mocapd.app.daemon.daemon_pictures import RecordingHeader
from mocapd.boundary.parsing import decode_json, decode_msgpack
from mocapd.client import Link
from mocapd.client import connect as connect_to_bus
from mocapd.outputs.messages import CameraStatus
from mocapd.outputs.wire import SkeletonFrame
from mocapd.outputs.zenoh import keys
from mocapd.web.runtime_file import Running, running
from mocapd.web.watcher import socket_address
from tests.cli.mocapd_process import COMMAND
from tests.faults.row import ROOT
from tests.outputs.frames import free_port

INSTANCE = "faults"
START_S = 300.0  # the first start ever compiles, and renders the film


@dataclass(frozen=True, slots=True)
class SeenPicture:
    """A picture as the page's recorder gets it: of which camera, what it shows, and when it came."""

    camera: str
    unix_ns: int
    shows: str
    came_s: float


@dataclass(frozen=True, slots=True)
class SeenBody:
    """What of a skeleton frame matters here, and when it came."""

    seq: int
    t_ns: int
    unix_ns: int
    tracking: str
    cameras: tuple[str, ...]
    came_s: float


class FaultyDaemon:
    """A process that serves; `pictures` and `bodies` grow by what comes, `told` has each camera's newest status."""

    def __init__(
        self,
        folder: Path,
        words: tuple[str, ...],
        shows: Callable[[bytes], str] = lambda _: "",
        env: Mapping[str, str] | None = None,
    ) -> None:
        """shows: what a JPEG is a picture of; env: what its environment has besides."""
        self.folder, self.port, self._shows = folder, free_port(), shows
        self.log_path = folder / "log"
        self.pictures: list[SeenPicture] = []
        self.bodies: list[SeenBody] = []
        self.told: dict[str, CameraStatus] = {}
        self._opened = ExitStack()
        runtime = folder / "runtime"
        runtime.mkdir(mode=0o700, exist_ok=True)
        command = [
            *(*COMMAND, "run", "--instance", INSTANCE, "--set", f"zenoh.port={self.port}"),
            *("--set", "osc.enabled=false", *words),
        ]
        with self.log_path.open("ab") as log:
            self.process = subprocess.Popen(
                command,
                env={**environment_of(folder), **(env or {})},
                cwd=folder,
                stdout=log,
                stderr=log,
            )
        self.usage = psutil.Process(self.process.pid)

    @property
    def log(self) -> str:
        return self.log_path.read_text()

    def until(self, condition: Callable[[], object], what: str, within_s: float = START_S) -> None:
        """Wait for it. Raises RuntimeError when the daemon ends first, or the time is over."""
        until_s = time.monotonic() + within_s
        while not condition():
            if self.process.poll() is not None or time.monotonic() > until_s:
                raise RuntimeError(f"no {what}; the daemon says:\n{self.log[-4000:]}")
            time.sleep(0.05)

    def listen(self) -> None:
        """From now on everything is kept that it sends. Raises RuntimeError where it does not serve."""
        link = Link(f"tcp/127.0.0.1:{self.port}", INSTANCE)
        folder = self.folder / "runtime" / "mocapd"
        pages: list[Running] = []

        def has_page() -> bool:  # looked up once: a busy daemon may not answer a second time
            pages[:] = running(folder)
            return bool(pages)

        self.until(has_page, "page")
        session = self._opened.enter_context(connect_to_bus(link))
        for key, take in (
            (keys.skeleton(INSTANCE, 0), self._body),
            (keys.camera_status(INSTANCE, keys.ANY), self._status),
        ):
            handler = zenoh.handlers.Callback(take, indirect=False)
            self._opened.enter_context(session.declare_subscriber(key, handler))
        socket = self._opened.enter_context(
            connect(socket_address(pages[0].url, "/recording"), proxy=None, max_size=1 << 24)
        )

        def read() -> None:
            try:
                for data in socket:
                    self._picture(data if isinstance(data, bytes) else data.encode())
            except WebSocketException:
                return  # the daemon has ended, which others look at

        threading.Thread(target=read, daemon=True).start()

    def end(self) -> int:
        """SIGTERM; its exit code. Raises TimeoutExpired."""
        self._opened.close()
        self.process.terminate()
        return self.process.wait(30.0)

    def close(self) -> None:
        self._opened.close()
        self.process.kill()
        self.process.wait()

    def _picture(self, data: bytes) -> None:
        end = 4 + int.from_bytes(data[:4], "little")
        header = decode_json(data[4:end], RecordingHeader)
        if header.camera:
            now_s = time.monotonic()
            self.pictures.append(
                SeenPicture(header.camera, header.unix_ns, self._shows(data[end:]), now_s)
            )

    def _body(self, sample: zenoh.Sample) -> None:
        body = decode_msgpack(sample.payload.to_bytes(), SkeletonFrame)
        now_s = time.monotonic()
        self.bodies.append(
            SeenBody(
                body.seq,
                body.capture_monotonic_ns,
                body.capture_unix_ns,
                body.tracking,
                tuple(body.cameras),
                now_s,
            )
        )

    def _status(self, sample: zenoh.Sample) -> None:
        status = decode_msgpack(sample.payload.to_bytes(), CameraStatus)
        self.told[status.camera] = status


def environment_of(folder: Path) -> Mapping[str, str]:
    """Of a user whose home is this folder; what is made once and kept is the caller's own."""
    dropped = ("MOCAPD_", "JOURNAL_STREAM", "ZENOH_", "STATE_DIRECTORY", "NOTIFY_SOCKET")
    env = {k: v for k, v in os.environ.items() if not k.startswith(dropped)}
    own = {
        "XDG_CACHE_HOME": os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache")),
        "XDG_STATE_HOME": str(folder / "state"),
        "XDG_CONFIG_HOME": str(folder / "config"),
        "XDG_RUNTIME_DIR": str(folder / "runtime"),
    }
    return env | {"HOME": str(folder), "PYTHONPATH": str(ROOT)} | own


@contextmanager
def faulty_daemon(
    folder: Path,
    *words: str,
    shows: Callable[[bytes], str] = lambda _: "",
    env: Mapping[str, str] | None = None,
) -> Iterator[FaultyDaemon]:
    """One that serves, listened to; killed in the end."""
    daemon = FaultyDaemon(folder, words, shows, env)
    try:
        daemon.listen()
        yield daemon
    finally:
        daemon.close()
