"""An hour's frames in a quarter of an hour: nothing grows.

The scene with the jacket, filmed at four times the usual rate, so that both cues and the change between them work, somebody
leaves and comes back, and frames are dropped as on a machine that is too slow. Every output sends; a game and a page take.
"""

import math
import statistics
import tempfile
import time
from pathlib import Path

import psutil

from tests.faults.faulty_daemon import FaultyDaemon, faulty_daemon
from tests.faults.row import ROOT, Came, Extent, FaultRow

RATE_HZ = 120  # of the cameras, 30 in the scene as it ships
TIME_S = 900.0  # in which so many frames come as in an hour
PARTS = 200  # looks at it, the first fifth of them is the warm-up; a short run makes 25, as each takes 20 ms
MOST_MB, MOST_THREADS, MOST_FDS = 5.0, 0, 0  # growth since
LONGEST_SILENCE_S = 2.0


def run(extent: Extent) -> Came:
    """See FaultRow."""
    wrong: list[str] = []
    full = extent.share >= 1.0
    # a short run is a test on a machine that may be busy with others: how fast it is there is not judged
    longest_silence_s = LONGEST_SILENCE_S if full else math.inf
    with tempfile.TemporaryDirectory() as folder:
        # rendering an hour's frames takes minutes
        scene = _fast_scene(Path(folder)) if full else extent.room
        words = ("--capture", f"sim:{scene}", "--tracker", "auto")
        outputs = (
            "vmc.enabled=true",
            "vrchat.enabled=true",
            "vmt.enabled=true",
            "osc.enabled=true",
        )
        settings = [word for one in outputs for word in ("--set", one)]
        with faulty_daemon(Path(folder), *words, *settings) as daemon:
            daemon.until(lambda: daemon.bodies and daemon.pictures, "body and picture")
            usage, bodies, pictures = _watch(
                daemon, extent.of(TIME_S, 10.0), PARTS if full else 25, longest_silence_s, wrong
            )
            if (code := daemon.end()) != 0:
                wrong.append(f"exit code {code}")
            if "Traceback" in daemon.log:
                wrong.append(daemon.log[daemon.log.index("Traceback") :][:3000])
    fifth = len(usage) // 5
    at = [
        tuple(map(statistics.median, zip(*part, strict=True)))
        for part in (usage[fifth : 2 * fifth], usage[-fifth:])
    ]
    grown = [after - before for before, after in zip(*at, strict=True)]
    figures = (
        f"{bodies} messages and {pictures} pictures came; {at[1][0]:.0f} MB, {grown[0]:+.1f} MB, "
        f"{grown[1]:+.0f} threads, {grown[2]:+.0f} file descriptors since the warm-up"
    )
    # what is filled in a short run is the warm-up
    if any(
        more > most
        for more, most in zip(
            grown[not full :], (MOST_MB, MOST_THREADS, MOST_FDS)[not full :], strict=True
        )
    ):
        wrong.append(f"grown: {figures}")
    return Came(figures, tuple(wrong))


def _fast_scene(folder: Path) -> Path:
    scene = (ROOT / "calib" / "scenarios" / "jacket.toml").read_text()
    path = folder / "jacket.toml"
    path.write_text(scene.replace("fps_hz = 30.0", f"fps_hz = {RATE_HZ:.1f}"))
    return path


def _watch(
    daemon: FaultyDaemon, time_s: float, parts: int, longest_silence_s: float, wrong: list[str]
) -> tuple[list[tuple[float, int, int]], int, int]:
    """MB of its own, threads and descriptors at each look; how many messages and pictures came."""
    usage: list[tuple[float, int, int]] = []
    bodies = pictures = 0
    began_s = heard_s = time.monotonic()
    for part in range(1, parts + 1):
        time.sleep(max(0.0, began_s + part / parts * time_s - time.monotonic()))
        if daemon.process.poll() is not None:
            raise RuntimeError(f"the daemon ended:\n{daemon.log[-4000:]}")
        new = daemon.bodies[:]
        del daemon.bodies[: len(new)]
        for one in new:
            if one.came_s - heard_s > longest_silence_s:
                wrong.append(f"silent for {one.came_s - heard_s:.1f} s")
            heard_s = one.came_s
        bodies += len(new)
        pictures += len(daemon.pictures)
        daemon.pictures.clear()
        with daemon.usage.oneshot():
            now: psutil.Process = daemon.usage
            usage.append((_own_mb(now), now.num_threads(), now.num_fds()))
    if time.monotonic() - heard_s > time_s / parts + longest_silence_s:
        wrong.append("silent at the end")
    if bodies == 0:
        wrong.append("nothing came")
    return usage, bodies, pictures


def _own_mb(process: psutil.Process) -> float:
    """In memory or swapped out, without pages of libraries, which the system drops and reads again as it likes."""
    memory = process.memory_full_info()
    return float(memory.rss - memory.shared + memory.swap) / 1e6


ROW = FaultRow(
    "1 h of replay at 4x",
    "memory grows by less than 5 MB after warm-up, threads and file descriptors stay",
    run,
)
