"""SIGTERM at random moments, from the first import on: while it starts, while everything runs, while it takes up another
configuration."""

import random
import signal
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from tests.cli.own_time import waits_of
from tests.faults.faulty_daemon import FaultyDaemon
from tests.faults.row import Came, Extent, FaultRow

MOMENTS = 50  # half of them while it starts, a fifth during a reload
LIMIT_S = 2.0  # to end, of its own time: what it waits for a processor is not counted
_STARTS_S = 10.0  # within which it is told to end that starts
_SERVES_S = 3.0  # the same, of one that serves
_LOOK_S = 0.005
_CUT_SHORT = "the orderly end takes longer than"  # see `app.daemon.end_deadline`


@dataclass(eq=False)
class Ender:
    """Starts daemons and ends them. own_s, wall_s: what each took to end [s], without and with its waits for a processor."""

    folder: Path
    room: str
    rng: random.Random
    own_s: list[float] = field(default_factory=list)
    wall_s: list[float] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)

    def end_starting(self) -> None:
        """Told within its start, which a few seconds later is over."""
        daemon = self._daemon()
        try:
            daemon.until(lambda: _is_caught(daemon.process.pid), "handler of SIGTERM")
            after_s = self.rng.uniform(0.0, _STARTS_S)
            time.sleep(after_s)
            self._end(daemon, f"{after_s:.2f} s after its first handler")
        except RuntimeError as error:
            self.wrong.append(str(error))
        finally:
            daemon.close()

    def end_serving(self, reloads: bool) -> None:
        """Told while it serves a game and a page, and, if it `reloads`, prepares another session."""
        daemon = self._daemon()
        try:
            daemon.listen()
            daemon.until(lambda: daemon.bodies and daemon.pictures, "body and picture")
            if reloads:
                daemon.process.send_signal(signal.SIGHUP)
            after_s = self.rng.uniform(0.0, _SERVES_S)
            time.sleep(after_s)
            self._end(daemon, f"{after_s:.2f} s into {'a reload' if reloads else 'serving'}")
        except RuntimeError as error:
            self.wrong.append(str(error))
        finally:
            daemon.close()

    def _daemon(self) -> FaultyDaemon:
        """With every output, the page, and the tracker that most run."""
        words = ("--capture", f"sim:{self.room}")
        # every output, also where nobody takes anything
        more = ("vmc.enabled=true", "vrchat.enabled=true", "vmt.enabled=true", "osc.enabled=true")
        settings = [word for one in more for word in ("--set", one)]
        return FaultyDaemon(self.folder, (*words, *settings))

    def _end(self, daemon: FaultyDaemon, when: str) -> None:
        process = daemon.process
        of_ours = psutil.Process(process.pid).children(recursive=True)
        waited_s = waits_of(process.pid)
        before_s, began_s = waited_s(), time.monotonic()
        process.terminate()
        while process.poll() is None:
            wall_s = time.monotonic() - began_s
            own_s = wall_s - (waited_s() - before_s)
            if own_s > LIMIT_S:
                self.wrong.append(f"{when}: it did not end within {LIMIT_S:g} s")
                return
            time.sleep(_LOOK_S)
        wall_s = time.monotonic() - began_s
        self.wall_s.append(wall_s)
        self.own_s.append(max(0.0, wall_s - (waited_s() - before_s)))
        if process.returncode != 0:
            self.wrong.append(f"{when}: exit code {process.returncode}\n{daemon.log[-2000:]}")
        elif "Traceback" in daemon.log:
            self.wrong.append(f"{when}: a traceback\n{daemon.log[-2000:]}")
        left = [path for path in (self.folder / "runtime").rglob("*") if path.is_file()]
        if left and _CUT_SHORT not in daemon.log:
            self.wrong.append(f"{when}: {', '.join(path.name for path in left)} stays")
        for path in left:  # of a machine so busy that the deadline ended the process: whoever looks next removes them
            path.unlink()
        _, alive = psutil.wait_procs(of_ours, LIMIT_S)
        if alive:
            self.wrong.append(f"{when}: {len(alive)} of its processes live on")
        daemon.log_path.unlink()


def _is_caught(pid: int) -> bool:
    """Whether the process looks after SIGTERM itself: before, nothing of ours runs yet."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except FileNotFoundError:
        return False
    caught = int(status.partition("SigCgt:")[2].split()[0], 16)
    return bool(caught >> (signal.SIGTERM - 1) & 1)


def run(extent: Extent) -> Came:
    """See FaultRow."""
    count = round(extent.of(MOMENTS, 3))
    with tempfile.TemporaryDirectory() as folder:
        ender = Ender(Path(folder), extent.room, random.Random(extent.seed))
        for number in range(count):
            if number % 2 == 0:
                ender.end_starting()
            else:
                ender.end_serving(reloads=number % 5 == 1)
    slowest = max(ender.own_s, default=float("nan"))
    figures = (
        f"{len(ender.own_s)} of {count} ended, the slowest in {slowest:.2f} s of its own time"
        f" ({max(ender.wall_s, default=float('nan')):.2f} s by the clock)"
    )
    return Came(figures, tuple(ender.wrong))


ROW = FaultRow(
    "SIGTERM while everything runs, at 50 random moments from start on",
    "exit 0 in < 2 s",
    run,
)
