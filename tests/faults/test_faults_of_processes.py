"""Short runs of what befalls whole processes: they are killed, told to end, and go on for long."""

import re
from pathlib import Path

import pytest

from tests.conftest import environment
from tests.faults.short_run import short_runs

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory, cache_home: Path) -> dict[str, str]:
    """What each row prints."""
    env = environment(tmp_path_factory.mktemp("user"), cache_home)
    return short_runs(env, "killing", "ending", "soaking")


def test_processes_killed_while_they_save(rows: dict[str, str]) -> None:
    assert "8 kills" in rows["killing"]


def test_daemons_told_to_end_at_any_moment(rows: dict[str, str]) -> None:
    assert "3 of 3 ended" in rows["ending"]


def test_a_daemon_that_goes_on_and_on(rows: dict[str, str]) -> None:
    row = rows["soaking"]
    # a thread of the start may end late on a busy machine; the row says whether any came
    assert re.search(r"(\+0|-\d+) threads, \+0 file descriptors", row), row
