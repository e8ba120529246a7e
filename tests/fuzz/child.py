"""The process of one row: input after input, each with what came of it, how long it took, and how much memory."""

import ctypes
import faulthandler
import gc
import json
import os
import resource
import threading
import time
import traceback
from collections.abc import Mapping
from pathlib import Path
from random import Random
from types import TracebackType

import mocapd
from mocapd.errors import MocapdError
from tests.fuzz.network import keep_off
from tests.fuzz.row import Attempt, Place, Row

SLOW_S = 1.0  # that no input may take [s]
_SURELY_SLOW_S = 20.0  # beyond, it is not for the machine being busy
_REPEATS = 4  # of a slow one: the fastest counts
_MORE_MEMORY = 5 << 30  # that inputs may ask for, for the sake of the machine [bytes]
_SOURCES = str(Path(mocapd.__file__).parent)
_SCHEDULED = Path("/proc/self/schedstat")


class _Caught:
    """A context that nothing leaves: whatever was raised in it is `error`, also what nobody should raise."""

    error: BaseException | None = None

    def __enter__(self) -> "_Caught":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        self.error = error
        return True


class Tally(ctypes.Structure):
    """What the parent sees at any time. number: of the input at hand, -1 while it prepares; since_s: when
    that one began (CLOCK_MONOTONIC), 0 when none is at hand; the others: counts, seconds, bytes."""

    _fields_ = (
        ("number", ctypes.c_long),
        ("since_s", ctypes.c_double),
        ("taken", ctypes.c_long),
        ("refused", ctypes.c_long),
        ("unnamed", ctypes.c_long),
        ("slowest_s", ctypes.c_double),
        ("slowest", ctypes.c_long),
        ("more_bytes", ctypes.c_long),
        ("largest", ctypes.c_long),
    )


def run_row(
    row: Row, place: Place, seed: int, numbers: range, tally: Tally, found: Path, log: Path
) -> None:
    """Never returns: the process ends. Unnamed errors are appended to `found`, a line of JSON each."""
    _keep_apart(log)
    with _Caught() as end:
        _run(row, place, seed, numbers, tally, found)
    if end.error is not None:
        traceback.print_exception(end.error)
    os._exit(end.error is not None)  # whatever threads the inputs have left


def _run(row: Row, place: Place, seed: int, numbers: range, tally: Tally, found: Path) -> None:
    attempt = row.prepare(place)
    gc.collect()
    before = _forget_peak()
    with found.open("a") as lines:
        for number in numbers:
            tally.number, tally.since_s = number, time.monotonic()
            error = _one(attempt, f"{seed} {row.name} {number}", number, tally)
            tally.since_s = 0.0
            if error is not None:
                lines.write(json.dumps({"number": number, **error}) + "\n")
                lines.flush()
            more = _peak() - before
            if more > tally.more_bytes:
                tally.more_bytes, tally.largest = more, number


def _one(attempt: Attempt, seed: str, number: int, tally: Tally) -> Mapping[str, str] | None:
    """The unnamed error, if it came to one."""
    began_s, taken = _own_s(), False
    with _Caught() as end:
        taken = attempt(Random(seed), number)
    unnamed = None if isinstance(end.error, MocapdError) else end.error
    tally.taken += taken
    tally.refused += not taken and unnamed is None
    tally.unnamed += unnamed is not None
    took_s = _own_s() - began_s
    if SLOW_S < took_s < _SURELY_SLOW_S:
        took_s = min(took_s, *(_again_s(attempt, seed, number) for _ in range(_REPEATS)))
    if took_s > tally.slowest_s:
        tally.slowest_s, tally.slowest = took_s, number
    return None if unnamed is None else _described(unnamed)


def _again_s(attempt: Attempt, seed: str, number: int) -> float:
    """The machine may have been busy with something else."""
    began_s = _own_s()
    with _Caught():
        attempt(Random(seed), number)
    return _own_s() - began_s


def _own_s() -> float:
    """A clock that stands still while this thread could run and others had the processors [s]."""
    waited_ns = int(_SCHEDULED.read_text().split()[1]) if _SCHEDULED.exists() else 0
    return time.perf_counter() - 1e-9 * waited_ns


def _described(error: BaseException) -> Mapping[str, str]:
    """kind: the same for all that are alike."""
    cause = error.__cause__ or error
    frames = traceback.extract_tb(cause.__traceback__) or traceback.extract_tb(error.__traceback__)
    own = [one for one in frames if one.filename.startswith(_SOURCES)] or frames
    place = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else "?"
    what = " ".join(str(error).split())
    return {
        "kind": f"{type(error).__name__} at {place}",
        "what": what if len(what) < 160 else f"{what[:157]}...",
        "trace": "".join(traceback.format_exception(error))[-6000:],
    }


def _keep_apart(log: Path) -> None:
    """From the terminal, from other machines, and from all of the machine's memory."""
    with log.open("ab", buffering=0) as file:
        for descriptor in (1, 2):
            os.dup2(file.fileno(), descriptor)
    faulthandler.enable(2)
    threading.excepthook = lambda _: None  # a thread that dies is told by who had it
    keep_off()
    size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    limit = size + _MORE_MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit if hard < 0 else min(limit, hard), hard))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _forget_peak() -> int:
    """The process' memory now [bytes], from which on its peak counts."""
    Path("/proc/self/clear_refs").write_text("5")
    return _peak()


def _peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
