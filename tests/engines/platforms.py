"""`make platforms`: mocapd on each Python and machine that it is promised for; prints a table.

    python -m tests.engines.platforms [--only 3.13 3.14 aarch64] [--logs FOLDER]

First that every locked package has a wheel for each, which needs the index alone. Then it is installed from wheels for
Python 3.13 and 3.14 in a Debian sid of their own, and for ARM in one that is emulated (qemu-user; an hour or two on two
cores, as everything is compiled there): a short track of lossless pictures compared with this machine's, and for the
Pythons the demo and a part of the tests. What cannot be made here is skipped with a word.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.engines.chroot import Chroot, NoChrootError, arm64, sid
from tests.engines.lossless import write_lossless_capture
from tests.engines.python_checks import (
    Platform,
    demo,
    install,
    part_of_the_tests,
    track,
    track_here,
    wheel_of_this_checkout,
)
from tests.engines.results import Result, exit_code, left_out, table
from tests.supply.lock_files import ROOT

SECONDS = 1.0
PYTHONS = ("3.13", "3.14")
ARM = "aarch64"
ARM_PYTHON = "3.13"  # of Debian 13


def main() -> int:
    """The exit code."""
    options = argparse.ArgumentParser(prog="python -m tests.engines.platforms")
    options.add_argument("--only", nargs="+", choices=(*PYTHONS, ARM), default=(*PYTHONS, ARM))
    options.add_argument("--logs", type=Path, help="where to keep what is printed there")
    given = options.parse_args()
    logs = given.logs or Path(tempfile.mkdtemp(prefix="mocapd-platforms-"))
    logs.mkdir(parents=True, exist_ok=True)
    results = [_wheels()]
    with tempfile.TemporaryDirectory(prefix="mocapd-platforms-") as folder:
        place = Path(folder)
        write_lossless_capture(place / "capture", SECONDS)
        track_here(place / "capture", place / "here.npz")
        wheel = wheel_of_this_checkout(place / "wheel")
        for python in PYTHONS:
            if python in given.only:
                results += _in_chroot(sid, python, "x86_64", wheel, place, logs)
        if ARM in given.only:
            results += _in_chroot(arm64, ARM_PYTHON, ARM, wheel, place, logs)
    print(table(results))
    print(f"\nWhat was printed there: {logs}")
    return exit_code(results)


def _wheels() -> Result:
    command = [sys.executable, "-m", "tests.supply.wheels"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    said = (done.stdout + done.stderr).strip().splitlines() or ["no word"]
    return Result("locks", "wheels", said[0].removeprefix("wheels: "), "all", done.returncode == 0)


def _in_chroot(
    make: Callable[[], Chroot], python: str, machine: str, wheel: Path, place: Path, logs: Path
) -> Iterator[Result]:
    try:
        chroot = make()
    except NoChrootError as why:
        yield left_out(f"{python} {machine}", "everything", str(why))
        return
    inside = chroot.folder / "mocapd"
    inside.mkdir(exist_ok=True)
    work = Path(tempfile.mkdtemp(dir=inside, prefix="platforms-"))
    platform = Platform(chroot, python, machine, work, logs)
    is_emulated = machine == ARM
    try:
        installed = install(platform, wheel, with_tests=not is_emulated)
        yield installed
        if installed.good:
            yield track(platform, place / "capture", place / "here.npz")
            if not is_emulated:
                yield demo(platform)
                yield part_of_the_tests(platform)
    finally:
        shutil.rmtree(work)


if __name__ == "__main__":
    sys.exit(main())
