"""Do every fault to real processes, and print what came of it: one row of the table for each.

    python -m tests.faults [NAME...] [--seed N] [--share S]

A name that is the beginning of several does all of them; --share 0.025 is the short run of `make test`. Exit code 1
when something was not as it should be. All of them take half an hour; everything stays on 127.0.0.1 and in temporary
folders.
"""

import argparse
import logging
import random
import sys
import time

from tests.faults.row import Extent
from tests.faults.table import ROWS


def main(words: list[str]) -> int:
    """Run the named rows, or all; the exit code."""
    logging.basicConfig(level=logging.ERROR)  # a recording that was cut is what is wanted here
    parser = argparse.ArgumentParser(prog="python -m tests.faults")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(ROWS))
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    parser.add_argument("--share", type=float, default=1.0)
    asked = parser.parse_args(words)
    chosen = [name for name in ROWS if not asked.names or name.startswith(tuple(asked.names))]
    if not chosen:
        print("no such fault; there are: " + ", ".join(ROWS), file=sys.stderr)
        return 2
    print(f"seed {asked.seed}, share {asked.share:g}", flush=True)
    missed = 0
    for name in chosen:
        row = ROWS[name]
        began_s = time.monotonic()
        came = row.run(Extent(asked.seed, asked.share))
        missed += bool(came.wrong)
        took_s = time.monotonic() - began_s
        verdict = "MISS" if came.wrong else "ok"
        print(
            f"| {row.fault} | {row.wanted} | {verdict}: {came.figures} ({took_s:.0f} s) |",
            flush=True,
        )
        for one in came.wrong[:20]:
            print(f"    {one}", flush=True)
    print(f"{len(chosen) - missed} of {len(chosen)} held")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
