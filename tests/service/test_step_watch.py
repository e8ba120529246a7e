"""A step that takes long is told once, and that it is over; one that never ends ends the process."""

import subprocess
import sys

import pytest

from mocapd.service.step_watch import StepWatch, StuckStepError
from tests.conftest import ROOT


def test_a_long_step_is_told_once_and_that_it_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    watch = StepWatch(stuck_s=30.0)
    for step_s in (0.0, 0.03, 0.99):
        watch.look(step_s)
        assert watch.detail == ""
    for step_s in (1.2, 4.0):
        watch.look(step_s)
    assert watch.detail == "the tracker has worked on one picture for 4 s"
    watch.look(0.02)
    assert watch.detail == ""
    told = [one.getMessage() for one in caplog.records]
    assert told == [
        "the tracker takes long for one picture; those that come meanwhile are dropped",
        "the tracker goes on, after 4.0 s",
    ]


def test_one_that_does_not_end_is_an_error_that_says_which_key_to_change() -> None:
    with pytest.raises(StuckStepError, match=r"for 31 s.*tracker\.stuck_s") as caught:
        StepWatch(stuck_s=30.0).look(31.0)
    assert caught.value.exit_code == 70


def test_a_daemon_whose_tracker_is_stuck_ends_with_70(clean_env: dict[str, str]) -> None:
    ran = subprocess.run(
        [sys.executable, "-m", "tests.e2e.stuck_tracker"],
        cwd=ROOT,
        env=clean_env,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert ran.returncode == 70, ran.stderr
    assert "those that come meanwhile are dropped" in ran.stderr
    assert "the tracker has worked on one picture for 2 s" in ran.stderr
