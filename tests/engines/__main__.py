"""`make engines`: mocapd in Godot 4 and Blender, which run in a Debian sid of their own; prints a table.

    python -m tests.engines [--vmc-addon FOLDER] [--logs FOLDER]

Needs root, mmdebstrap and a Debian mirror in /etc/apt; where one is missing it says so and ends well. The chroot stays in
the cache for the next time (2 GB).
"""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from tests.engines.blender_checks import blender_checks
from tests.engines.chroot import NoChrootError, sid
from tests.engines.godot_checks import godot_checks, vmc_checks
from tests.engines.results import exit_code, table


def main() -> int:
    """The exit code."""
    options = argparse.ArgumentParser(prog="python -m tests.engines")
    options.add_argument(
        "--vmc-addon", type=Path, help="addons/godot_vmc_tracker of GodotXRVmcTracker"
    )
    options.add_argument("--logs", type=Path, help="where to keep what the engines print")
    given = options.parse_args()
    try:
        chroot = sid()
    except NoChrootError as why:
        print(f"engines: skipped: {why}")
        return 0
    logs = given.logs or Path(tempfile.mkdtemp(prefix="mocapd-engines-"))
    logs.mkdir(parents=True, exist_ok=True)
    inside = chroot.folder / "mocapd"
    inside.mkdir(exist_ok=True)
    work = Path(tempfile.mkdtemp(dir=inside, prefix="engines-"))
    try:
        results = [
            *godot_checks(chroot, work, logs),
            *vmc_checks(chroot, work, logs, given.vmc_addon),
            *blender_checks(chroot, work, logs),
        ]
    finally:
        shutil.rmtree(work)
    print(table(results))
    print(f"\nWhat the engines printed: {logs}")
    return exit_code(results)


if __name__ == "__main__":
    sys.exit(main())
