"""How long a process takes by itself: what it waited for a processor is the busy machine's doing."""

import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

PATIENCE_S = 120.0  # after which a process is given up, however busy the machine is [s]
_LOOK_EVERY_S = 0.01


def end_within(process: subprocess.Popen[str], limit_s: float) -> str:
    """What it still says on stderr until it has ended, within this time of its own.

    Killed when it has not; the caller sees that by its exit code.
    """
    began_s, waits_s = time.monotonic(), dict[Path, float]()
    threads = Path(f"/proc/{process.pid}/task"), Path("/proc/thread-self").resolve().parent
    with ThreadPoolExecutor(1) as pool:
        reading = pool.submit(process.communicate)
        before_s = _look(threads, waits_s)
        while not reading.done():
            took_s = time.monotonic() - began_s
            if took_s - (_look(threads, waits_s) - before_s) > limit_s or took_s > PATIENCE_S:
                process.kill()
            time.sleep(_LOOK_EVERY_S)
        return reading.result()[1]


def _look(folders: tuple[Path, ...], waits_s: dict[Path, float]) -> float:
    """How long all threads of these folders of /proc have waited for a processor [s]; those that have
    ended since the last look are remembered in `waits_s`."""
    for folder in folders:
        for thread in folder.glob("*/schedstat"):
            with suppress(OSError, IndexError):  # it has just ended
                waits_s[thread] = 1e-9 * int(thread.read_text().split()[1])
    return sum(waits_s.values())
