"""A short run of the fuzzers: a hundredth of every row's inputs ends in values and named errors only."""

from pathlib import Path

from tests.module_run import module_run

_SCALE = "0.01"


def test_no_input_ends_in_an_unnamed_error(clean_env: dict[str, str], cache_home: Path) -> None:
    """In a process of its own, as `make fuzz` does: its rows are forked, which threads do not survive."""
    jobs = "3"  # some of them wait more than they work
    cache = str(cache_home / "fuzz")
    module_run(clean_env, "tests.fuzz", "--scale", _SCALE, "--jobs", jobs, "--cache", cache)
