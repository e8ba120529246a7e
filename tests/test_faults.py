"""A short run of the faults: what half an hour of them shows, in seconds."""

import os
import subprocess
import sys

import pytest

from tests.conftest import ROOT

pytestmark = pytest.mark.long

SHARE = "0.03"


def fault(name: str, env: dict[str, str], share: str = SHARE) -> str:
    """What a row prints; the test fails with it when something was not as it should be."""
    ran = subprocess.run(
        [sys.executable, "-m", "tests.faults", name, "--share", share],
        cwd=ROOT,
        env=env | {"PATH": os.environ["PATH"]},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def test_cameras_pulled_out_and_put_back_at_random(clean_env: dict[str, str]) -> None:
    assert "uses of a picture compared" in fault("unplugging", clean_env)


def test_processes_killed_while_they_save(clean_env: dict[str, str]) -> None:
    assert "8 kills" in fault("killing", clean_env)


def test_daemons_told_to_end_at_any_moment(clean_env: dict[str, str]) -> None:
    assert "3 of 3 ended" in fault("ending", clean_env)


def test_cameras_that_are_not_well(clean_env: dict[str, str]) -> None:
    assert "6 faults" in fault("ailing", clean_env)


def test_a_daemon_that_goes_on_and_on(clean_env: dict[str, str]) -> None:
    assert "+0 threads, +0 file descriptors" in fault("soaking", clean_env, "0.01")
