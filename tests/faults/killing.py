"""Processes killed at random moments while they save: what was saved before is there, whole, and all start again."""

import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from mocapd.errors import MocapdError
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.wire import SkeletonFrame
from tests.faults.endless_writer import cached_number, saved_number
from tests.faults.faulty_daemon import FaultyDaemon, environment_of
from tests.faults.row import ROOT, Came, Extent, FaultRow
from tests.outputs.recorded import HZ

KILLS = 200  # of which every fourth goes to each of four kinds
_WRITES_S = 0.5  # within which a writer is killed once it writes
_STARTS_S = 4.0  # within which a daemon is killed that starts
_LOST_FRAMES = HZ  # of a recording at most: a second


class Killer:
    """Kills, and looks at what is left."""

    def __init__(self, folder: Path, seed: int, room: str) -> None:
        self.folder, self.room = folder, room
        self.wrong: list[str] = []
        self.most_lost = 0  # frames of a recording
        self._rng = random.Random(seed)
        self._written: dict[str, int] = {"calibration": -1, "cache": -1}
        for name in self._written:
            (folder / name).mkdir(mode=0o700)

    def kill_writer(self, kind: str, read: Callable[[Path], int | None]) -> None:
        """While it writes the file of this kind over and over."""
        place, before = self.folder / kind, self._written[kind]
        words = ("tests.faults.endless_writer", kind, str(place), str(before + 1))
        said = self._killed(words, "begun")
        written = int(said[-1]) if said else before
        try:
            found = read(place)
        except MocapdError as error:
            self.wrong.append(f"{kind} after {written}: {error}")
            return
        # the one that was under way when the kill came may have been moved into place already
        if (found if found is not None else -1) not in (written, written + 1):
            self.wrong.append(f"{kind}: {written} was written, {found} is there")
        self._written[kind] = written if found is None else found

    def kill_recorder(self, number: int) -> None:
        """While it records."""
        path = self.folder / f"{number}.mcap"
        said = self._killed(("tests.outputs.killed_recorder", str(path)), "0")
        handed_over = int(said[-1]) + 1 if said else 1
        try:
            read = sum(isinstance(one, SkeletonFrame) for one in RecordingReader(path).everything())
        except MocapdError as error:
            if "holds no frame of mocapd: it was not closed" not in str(error):
                self.wrong.append(f"recording of {handed_over} frames: {error}")
                return
            read = 0
        finally:
            path.unlink(missing_ok=True)
        self.most_lost = max(self.most_lost, handed_over - read)
        if handed_over - read > _LOST_FRAMES:
            self.wrong.append(f"recording: {handed_over - read} of {handed_over} frames are lost")

    def kill_daemon(self) -> None:
        """While it starts, then when it serves, which it must after that."""
        home = self.folder / "home"
        home.mkdir(exist_ok=True)
        words = ("--capture", f"sim:{self.room}", "--tracker", "canned")
        starting = FaultyDaemon(home, words)
        time.sleep(self._rng.uniform(0.0, _STARTS_S))
        starting.close()
        serving = FaultyDaemon(home, words)
        try:
            serving.listen()
            serving.until(lambda: serving.bodies, "body")
            time.sleep(self._rng.uniform(0.0, 0.5))
        except RuntimeError as error:
            self.wrong.append(str(error))
        finally:
            serving.close()

    def left(self) -> list[str]:
        """Files half written that nobody will remove."""
        return [
            str(path.relative_to(self.folder))
            for kind in self._written
            for path in (self.folder / kind).rglob(".*.*.??????*")
            if path.is_file()
        ]

    def _killed(self, words: tuple[str, ...], begun: str) -> list[str]:
        """The lines that it said after it had begun."""
        with subprocess.Popen(
            [sys.executable, "-m", *words],
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=environment_of(self.folder),
        ) as process:
            assert process.stdout is not None
            if process.stdout.readline().strip() != begun:
                raise RuntimeError(f"{words[0]} does not begin")
            time.sleep(self._rng.uniform(0.0, _WRITES_S))
            if process.poll() is not None:
                raise RuntimeError(f"{words[0]} ended by itself")
            process.kill()
            return process.stdout.read().split()


def run(extent: Extent) -> Came:
    """See FaultRow."""
    each = round(extent.of(KILLS / 4, 2))
    with tempfile.TemporaryDirectory() as folder:
        killer = Killer(Path(folder), extent.seed, extent.room)
        for number in range(each):
            killer.kill_writer("calibration", saved_number)
            killer.kill_writer("cache", cached_number)
            killer.kill_recorder(number)
            if number % 2 == 0:  # two kills
                killer.kill_daemon()
        wrong = list(killer.wrong)
        left = killer.left()
        if len(left) > 8:  # what the last two kills may leave goes with the next save
            wrong.append(f"half written files stay: {left}")
    figures = (
        f"{4 * each} kills, {each} each while a calibration, a cache and a recording is written, {each} of the daemon; at "
        f"most {killer.most_lost} frames of a recording lost ({killer.most_lost / HZ:.2f} s), {len(left)} half written "
        "files, which the next save removes"
    )
    return Came(figures, tuple(wrong))


ROW = FaultRow(
    "`kill -9` at 200 random moments (calibration save, cache write, recording)",
    "starts again each time; no file half written; nothing saved before is lost",
    run,
)
