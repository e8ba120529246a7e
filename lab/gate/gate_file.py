"""The measured figures as a file: which commit, which machine, and what each run gave."""

import platform
import subprocess
import time
from pathlib import Path

import msgspec
import numpy as np

from mocapd.boundary.files import read_text
from mocapd.errors import InputError, MalformedError, creation_errors
from mocapd.types import Floats
from mocapd.whole_file import whole_file

SCHEMA = 1
_MOST_BYTES = 16 << 20
_LOOPS = 200


class GateRow(msgspec.Struct, frozen=True, kw_only=True):
    """What was measured of one recording; runs: by figure one value a run."""

    set_name: str
    name: str
    joints: str
    runs: dict[str, list[float]]

    @property
    def key(self) -> tuple[str, str]:
        return self.set_name, self.name


class GateFile(msgspec.Struct, frozen=True, kw_only=True):
    """commit: of the tree that was measured, with "+" where files differ from it; loop_ms: a fixed numpy loop on this
    machine, so that times of two files can be compared."""

    schema: int
    commit: str
    tracker: str
    python: str
    loop_ms: float
    rows: list[GateRow]


def new_file(tracker: str, rows: list[GateRow], root: Path) -> GateFile:
    """Of the checkout in `root`, as it stands now."""
    return GateFile(
        schema=SCHEMA,
        commit=commit_of(root),
        tracker=tracker,
        python=platform.python_version(),
        loop_ms=loop_ms(),
        rows=rows,
    )


def commit_of(root: Path) -> str:
    """Short, with "+" where files differ from it; empty outside of git."""

    def git(*words: str) -> str:
        done = subprocess.run(
            ["git", *words], cwd=root, capture_output=True, text=True, check=False
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    commit = git("rev-parse", "--short", "HEAD")
    return f"{commit}+" if commit and git("status", "--porcelain") else commit


def loop_ms() -> float:
    """The least time [ms] of a fixed loop of small numpy work, as a tracker does."""
    half: Floats = np.random.default_rng(1).standard_normal((69, 69))
    A: Floats = half @ half.T + 69.0 * np.eye(69)
    b: Floats = np.ones(69)
    least_s = np.inf
    for _ in range(5):
        start_s = time.perf_counter()
        for _ in range(_LOOPS):
            np.linalg.solve(A, b)
        least_s = min(least_s, time.perf_counter() - start_s)
    return float(1000.0 * least_s)


def write_gate(path: Path, file: GateFile) -> None:
    """Raises CannotCreateError."""
    with creation_errors(path, "choose another place with --out"), whole_file(path) as partial:
        partial.write_bytes(msgspec.json.format(msgspec.json.encode(file), indent=1))


def read_gate(path: Path) -> GateFile:
    """Raises InputError."""
    try:
        return msgspec.json.decode(read_text(path, _MOST_BYTES), type=GateFile)
    except (msgspec.DecodeError, MalformedError) as error:
        raise InputError(f"is no file of the gate ({error})", str(path)) from None
