"""Attack a real daemon, and print what came of it: one row for each scenario.

    python -m tests.attacks [NAME...]

A name that is the beginning of several does all of them. Exit code 1 when a figure was missed. All
of them take some ten minutes; everything stays on 127.0.0.1.
"""

import sys
import time

from tests.attacks.table import SCENARIOS


def main(names: list[str]) -> int:
    """Run the named scenarios, or all; the exit code."""
    chosen = [key for key in SCENARIOS if not names or key.startswith(tuple(names))]
    if not chosen:
        print("no such attack; there are: " + ", ".join(SCENARIOS), file=sys.stderr)
        return 2
    width = max(map(len, chosen))
    wanted_width = max(len(SCENARIOS[name].wanted) for name in chosen)
    missed = 0
    for name in chosen:
        scenario = SCENARIOS[name]
        began_s = time.monotonic()
        found = scenario.attack()
        missed += not found.holds
        verdict = "ok  " if found.holds else "MISS"
        took = f"({time.monotonic() - began_s:.0f} s)"
        print(
            f"{verdict} {name:<{width}}  {scenario.wanted:<{wanted_width}}  {found.figure} {took}",
            flush=True,
        )
    print(f"{len(chosen) - missed} of {len(chosen)} held")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
