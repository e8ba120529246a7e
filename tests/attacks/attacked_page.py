"""The page that is attacked: of `mocapd run` on simulated cameras, with a home of its own."""

import json
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import psutil

from mocapd.web.games.frames_access import FILE_NAME
from tests.attacks.attacked import daemon_process

SITE = "https://game.example"  # whose pages may have the frames
START_S = 300.0  # the first start ever compiles, and renders the film
PATIENCE_S = 30.0


@dataclass(frozen=True)
class AttackedPage:
    """A running daemon: its process, its page's port and token, the key of SITE, and what it wrote to stderr so far."""

    process: subprocess.Popen[bytes]
    port: int
    token: str
    frames_key: str
    log: Path

    @property
    def host(self) -> str:
        """As its requests must name it."""
        return f"127.0.0.1:{self.port}"

    def answers(self, within_s: float) -> float | None:
        """How long a newcomer with the token waits [s]; None for longer than this."""
        began_s = time.monotonic()
        try:
            httpx.get(
                f"http://{self.host}/status?token={self.token}", trust_env=False, timeout=within_s
            ).raise_for_status()
        except httpx.HTTPError:
            return None
        took_s = time.monotonic() - began_s
        return took_s if took_s <= within_s else None

    def cpu_s(self) -> float:
        """Processor time so far [s]."""
        times = psutil.Process(self.process.pid).cpu_times()
        return float(times.user + times.system)

    def last_error(self) -> str:
        """The last line of the last traceback."""
        lines = self.log.read_text(errors="replace").splitlines()
        ends = [line for line in lines if line[:1].isalpha() and "Error" in line.partition(":")[0]]
        return ends[-1][:100] if ends else ""


@contextmanager
def attacked_page() -> Iterator[AttackedPage]:
    """A daemon whose page answers; killed in the end."""
    words = ("--set", "zenoh.enabled=false", "--set", f'web.allow_origins=["{SITE}"]')
    with daemon_process(*words) as (process, log):
        said = log.parent / "mocapd" / f"page-{process.pid}.json"
        until_s = time.monotonic() + START_S
        while not said.exists():
            if process.poll() is not None or time.monotonic() > until_s:
                raise RuntimeError(f"there is no page:\n{log.read_text()}")
            time.sleep(0.1)
        told = json.loads(said.read_text())
        frames_key = (said.parent / FILE_NAME).read_text().strip()
        yield AttackedPage(process, told["port"], told["token"], frames_key, log)
