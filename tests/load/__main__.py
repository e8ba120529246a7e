"""`python -m tests.load [NAME...]`: many nodes, many streams, bad subscribers; prints what was measured, as Markdown.

Everything runs on this machine and on 127.0.0.1, some five minutes. Nothing is judged: it says how busy the machine was
with other things, and the figures are to be read with that.
"""

import argparse
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import psutil

from tests.load.bad_subscribers import bad_subscriber_table, measure_bad_subscribers
from tests.load.camera_nodes import measure_camera_nodes, node_table
from tests.load.streams import measure_streams, stream_table

SCALES = ((1, 6), (8, 50), (16, 100), (32, 200))  # streams, subscribers


def _nodes(folder: Path, seconds: float) -> str:
    return node_table(measure_camera_nodes(folder, 8, seconds))


def _streams(_folder: Path, seconds: float) -> str:
    return stream_table([measure_streams(*scale, seconds=seconds / 2) for scale in SCALES])


def _bad_subscribers(folder: Path, seconds: float) -> str:
    return bad_subscriber_table(measure_bad_subscribers(folder, 50, 5, 5, seconds))


LOADS: dict[str, Callable[[Path, float], str]] = {
    "nodes": _nodes,
    "streams": _streams,
    "bad-subscribers": _bad_subscribers,
}


def main() -> None:
    """One table after the other."""
    options = argparse.ArgumentParser(prog="python -m tests.load")
    options.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(LOADS)}")
    options.add_argument("--seconds", type=float, default=60.0, help="each is measured for so long")
    given = options.parse_args()
    unknown = set(given.names) - LOADS.keys()
    if unknown:
        options.error(f"there is no {', '.join(sorted(unknown))}; there are {', '.join(LOADS)}")
    busy = psutil.cpu_percent(interval=2.0)
    print(f"{os.cpu_count()} cores, busy with other things by {busy:.0f} % before\n", flush=True)
    for name in given.names or LOADS:
        with tempfile.TemporaryDirectory(prefix="mocapd-load-") as folder:
            print(LOADS[name](Path(folder), given.seconds), flush=True)
        print(flush=True)


if __name__ == "__main__":
    main()
