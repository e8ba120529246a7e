"""Short runs of faults, one after the other in one process: what half an hour of them shows, in seconds."""

from tests.module_run import PATIENCE_S, module_run

SHARE = "0.01"  # of each row the least that it does


def short_runs(env: dict[str, str], *names: str) -> dict[str, str]:
    """What each row prints, by name, in the table's order; the test fails with all of it when something was not as it
    should be."""
    words = (*names, "--share", SHARE)
    printed = module_run(env, "tests.faults", *words, patience_s=len(names) * PATIENCE_S)
    rows = [line for line in printed.splitlines() if line.startswith("| ")]
    return dict(zip(names, rows, strict=True))
