"""Short runs of what befalls whole processes: they are killed, told to end, and go on for long."""

import re

import pytest

from tests.faults.short_run import short_run

pytestmark = pytest.mark.long


def test_processes_killed_while_they_save(clean_env: dict[str, str]) -> None:
    assert "8 kills" in short_run("killing", clean_env)


def test_daemons_told_to_end_at_any_moment(clean_env: dict[str, str]) -> None:
    assert "3 of 3 ended" in short_run("ending", clean_env)


def test_a_daemon_that_goes_on_and_on(clean_env: dict[str, str]) -> None:
    row = short_run("soaking", clean_env, "0.01")
    # a thread of the start may end late on a busy machine; the row says whether any came
    assert re.search(r"(\+0|-\d+) threads, \+0 file descriptors", row), row
