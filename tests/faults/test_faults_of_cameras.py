"""Short runs of what befalls cameras, apart from those of processes: most of their time is waiting."""

import pytest

from tests.faults.short_run import short_run

pytestmark = pytest.mark.long


def test_cameras_pulled_out_and_put_back_at_random(clean_env: dict[str, str]) -> None:
    assert "uses of a picture compared" in short_run("unplugging", clean_env)


def test_cameras_that_are_not_well(clean_env: dict[str, str]) -> None:
    assert "6 faults" in short_run("ailing", clean_env)
