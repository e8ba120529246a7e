"""`python -m tests.fuzz`: every parser gets its inputs; ends with 1 when one ends in something unnamed, takes
longer than a second, or needs more than 200 MB."""

import argparse
import math
import os
import sys
import tempfile
from pathlib import Path

# before numpy: pools of threads do not survive the processes that are made of this one
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

from tests.fuzz.registry import ROWS
from tests.fuzz.report import is_good, show
from tests.fuzz.row import Row
from tests.fuzz.runner import Outcome, Running, run_rows, usual_jobs

_FEWEST = 4  # inputs of a row at any scale


def main() -> int:
    """The exit code."""
    options = _options()
    if options.list:
        for row in ROWS:
            print(f"{row.name:24}{row.inputs:7}")
        return 0
    scales = _scales(options)
    rows = [row for row in ROWS if not options.only or row.name in options.only]
    if options.input is None:
        chosen = [(row, range(_scaled(row.inputs, scales[row.is_slow]))) for row in rows]
    else:
        chosen = [(row, range(options.input, options.input + 1)) for row in rows]
    with tempfile.TemporaryDirectory(prefix="mocapd-fuzz-") as folder:
        cache = options.cache or Path(folder) / "cache"
        cache.mkdir(parents=True, exist_ok=True)
        outcomes = _with_bars(chosen, options, Path(folder), cache)
    outcomes.sort(key=lambda one: rows.index(one.row))
    show(outcomes, options.seed, Console(width=None if sys.stdout.isatty() else 120))
    if options.input is not None:
        for found in (found for one in outcomes for found in one.found):
            print(found.trace or found.what)
    return 0 if all(is_good(one) for one in outcomes) else 1


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser("python -m tests.fuzz", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of all that is random")
    many = parser.add_mutually_exclusive_group()
    many.add_argument("--scale", type=float, default=1.0, help="share of the inputs")
    many.add_argument(
        "--inputs", type=int, help="so many, if all rows are run: 1000000 takes an hour"
    )
    parser.add_argument(
        "--only", nargs="+", metavar="NAME", choices=[row.name for row in ROWS], help="these rows"
    )
    parser.add_argument("--input", type=int, help="this one alone, with its traceback")
    parser.add_argument("--jobs", type=int, default=usual_jobs(), help="rows at once")
    parser.add_argument("--cache", type=Path, help="keep here what takes long to make")
    parser.add_argument("--list", action="store_true", help="the rows and their inputs")
    return parser.parse_args()


def _scales(options: argparse.Namespace) -> tuple[float, float]:
    """Shares of a row's inputs: usual, of slow ones."""
    if options.inputs is None:
        return options.scale, options.scale
    usual = sum(row.inputs for row in ROWS if not row.is_slow)
    slow = sum(row.inputs for row in ROWS) - usual
    scale_of_slow = min(1.0, options.inputs / (usual + slow))
    return max(0.0, options.inputs - scale_of_slow * slow) / usual, scale_of_slow


def _scaled(inputs: int, scale: float) -> int:
    return max(min(inputs, _FEWEST), math.ceil(inputs * scale))


def _with_bars(
    chosen: list[tuple[Row, range]], options: argparse.Namespace, folder: Path, cache: Path
) -> list[Outcome]:
    bars = Progress(
        TextColumn("{task.description:24}"),
        BarColumn(),
        MofNCompleteColumn(),
        console=Console(stderr=True),
        transient=True,
        disable=not sys.stderr.isatty(),
    )
    tasks: dict[str, TaskID] = {}
    with bars:
        whole = bars.add_task("all", total=sum(len(numbers) for _, numbers in chosen))
        done: dict[str, int] = {}

        def told(one: Running) -> None:
            name, inputs = one.outcome.row.name, one.outcome.inputs
            if name not in tasks:
                tasks[name] = bars.add_task(name, total=inputs)
            if done.get(name) == one.done:
                return
            done[name] = one.done
            bars.update(tasks[name], completed=one.done, visible=one.done < inputs - 1)
            bars.update(whole, completed=sum(done.values()))

        return run_rows(chosen, options.seed, options.jobs, folder, cache, told)


if __name__ == "__main__":
    sys.exit(main())
