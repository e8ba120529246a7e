"""Runs rows, each in a process of its own: one that crashes or hangs is ended, and goes on with the next input."""

import gc
import json
import multiprocessing
import os
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from multiprocessing.sharedctypes import RawValue
from pathlib import Path

from tests.fuzz.child import Tally, run_row
from tests.fuzz.row import Place, Row

HANG_S = 60.0  # after which one input counts as never ending, also on a machine that is busy with others [s]
_PREPARE_S = 600.0  # its kernels may have to be compiled first
_MOST_DEATHS = 12  # of a row, before it is given up
_LOOK_EVERY_S = 0.05

_FORK = multiprocessing.get_context("fork")


@dataclass(frozen=True, slots=True)
class Found:
    """An unnamed error, or a row's end by itself. kind: type and place; number: of the input."""

    number: int
    kind: str
    what: str
    trace: str = ""


@dataclass(slots=True)
class Outcome:
    """What came of a row; taken and refused: inputs; more_mb: of memory at the peak; slowest, largest: the
    numbers of those inputs."""

    row: Row
    inputs: int
    taken: int = 0
    refused: int = 0
    found: list[Found] = field(default_factory=list)
    slowest_s: float = 0.0
    slowest: int = -1
    more_mb: float = 0.0
    largest: int = -1

    @property
    def unnamed(self) -> int:
        """Inputs that ended in something unnamed."""
        return len(self.found)


class Running:
    """One row, from its first input to its last."""

    def __init__(self, row: Row, numbers: range, seed: int, folder: Path, cache: Path) -> None:
        self._row, self._numbers, self._seed = row, numbers, seed
        self._folder, self._cache = folder, cache
        self._said, self._log = folder / "found", folder / "output"
        self._said.touch()
        self._log.touch()
        self._ends: list[Found] = []
        self._tally: Tally
        self._starts = 0
        self.outcome = Outcome(row, len(numbers))
        self._start(numbers)

    @property
    def done(self) -> int:
        """Inputs so far."""
        number: int = self._tally.number
        return max(0, number - self._numbers.start)

    def look(self) -> bool:
        """Whether it has ended; a process that died or hangs is followed by another."""
        if self._process.is_alive():
            since_s: float = self._tally.since_s
            hangs = since_s > 0.0 and time.monotonic() - since_s > HANG_S
            late = time.monotonic() - self._began_s > _PREPARE_S and self._tally.number < 0
            if not hangs and not late:
                return False
            self._process.kill()
            self._process.join()
            return self._died("NeverEnds" if hangs else "NotPrepared", f"more than {HANG_S:g} s")
        if self._process.exitcode == 0:
            self._collect()
            return True
        return self._died(f"Ended by {self._process.exitcode}", self._last_words())

    def kill(self) -> None:
        """End it now."""
        self._process.kill()
        self._process.join()

    def _start(self, numbers: range) -> None:
        self._starts += 1
        own = self._folder / f"files-{self._starts}"
        own.mkdir()
        self._tally = RawValue(Tally)
        self._tally.number = -1
        self._began_s = time.monotonic()
        self._process = _FORK.Process(
            target=run_row,
            args=(
                self._row, Place(own, self._cache), self._seed, numbers, self._tally, self._said,
                self._log,
            ),
        )  # fmt: skip
        self._process.start()

    def _died(self, kind: str, what: str) -> bool:
        self._collect()
        number: int = self._tally.number
        self._ends.append(Found(number, kind, what))
        self.outcome.found.append(self._ends[-1])
        left = range(number + 1, self._numbers.stop)
        if number < 0 or not left or len(self._ends) >= _MOST_DEATHS:
            if left:
                self.outcome.found.append(Found(number, "GivenUp", f"{len(left)} inputs are left"))
            return True
        self._start(left)
        return False

    def _collect(self) -> None:
        """What the process that ended has found."""
        out, tally = self.outcome, self._tally
        out.taken += tally.taken
        out.refused += tally.refused
        if tally.slowest_s > out.slowest_s:
            out.slowest_s, out.slowest = tally.slowest_s, tally.slowest
        if tally.more_bytes / 1e6 > out.more_mb:
            out.more_mb, out.largest = tally.more_bytes / 1e6, tally.largest
        lines = [json.loads(line) for line in self._said.read_text().splitlines()]
        out.found = sorted([Found(**line) for line in lines] + self._ends, key=lambda f: f.number)

    def _last_words(self) -> str:
        return self._log.read_text(errors="replace")[-3000:].strip()


def run_rows(
    rows: Iterable[tuple[Row, range]],
    seed: int,
    jobs: int,
    folder: Path,
    cache: Path,
    told: Callable[[Running], None],
) -> list[Outcome]:
    """Every row with its inputs, `jobs` at once. `told` is called often with each that runs."""
    gc.collect()
    gc.freeze()  # else every child would copy all of it by looking through it
    waiting, running, outcomes = list(rows), list[Running](), list[Outcome]()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                row, numbers = waiting.pop(0)
                own = folder / row.name
                own.mkdir()
                running.append(Running(row, numbers, seed, own, cache))
            for one in tuple(running):
                if one.look():
                    running.remove(one)
                    outcomes.append(one.outcome)
                told(one)
            time.sleep(_LOOK_EVERY_S)
    finally:
        for one in running:
            one.kill()
    return outcomes


def usual_jobs() -> int:
    """As many as there are processors, but two at most: times are measured."""
    return min(2, os.cpu_count() or 1)
