"""How long something takes by itself: what it waited for a processor is the busy machine's doing."""

import subprocess
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

PATIENCE_S = 600.0  # after which a process is given up, however busy the machine is [s]
_LOOK_EVERY_S = 0.01
_OWN = Path("/proc/self/task")


def end_within(process: subprocess.Popen[str], limit_s: float) -> tuple[str, str]:
    """What it still says on stdout and stderr until it has ended, within this time of its own.

    Killed when it has not; the caller sees that by its exit code.
    """
    began_s = time.monotonic()
    took_s = _since_now(Path(f"/proc/{process.pid}/task"), _OWN)
    with ThreadPoolExecutor(1) as pool:
        reading = pool.submit(process.communicate)
        while not reading.done():
            if took_s() > limit_s or time.monotonic() - began_s > PATIENCE_S:
                process.kill()
            time.sleep(_LOOK_EVERY_S)
        return reading.result()


def own_time() -> Callable[[], float]:
    """What tells how long this process took from now on [s]."""
    return _since_now(_OWN)


def waits_of(pid: int) -> Callable[[], float]:
    """What tells how long all threads of a process together have waited for a processor [s]."""
    return _waits(Path(f"/proc/{pid}/task"))


def _since_now(*folders: Path) -> Callable[[], float]:
    """What tells the time from now on [s], without what threads of these folders of /proc waited for a
    processor."""
    waited_s = _waits(*folders)
    began_s = time.monotonic() - waited_s()
    return lambda: time.monotonic() - waited_s() - began_s


def _waits(*folders: Path) -> Callable[[], float]:
    """What tells how long threads of these folders of /proc have waited for a processor [s]; of those that end,
    what they had waited when it was asked last."""
    waits_ns: dict[Path, int] = {}

    def waited_s() -> float:
        for folder in folders:
            with suppress(FileNotFoundError):  # the process has just ended
                for thread in [*folder.iterdir()]:
                    with suppress(OSError, IndexError):  # or the thread
                        waited_ns = (thread / "schedstat").read_text().split()[1]
                        waits_ns[thread] = int(waited_ns)
        return 1e-9 * sum(waits_ns.values())

    return waited_s
