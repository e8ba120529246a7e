"""Short runs of what befalls cameras, apart from those of processes: most of their time is waiting."""

from pathlib import Path

import pytest

from tests.conftest import environment
from tests.faults.short_run import short_runs

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory, cache_home: Path) -> dict[str, str]:
    """What each row prints."""
    env = environment(tmp_path_factory.mktemp("user"), cache_home)
    return short_runs(env, "unplugging", "ailing")


def test_cameras_pulled_out_and_put_back_at_random(rows: dict[str, str]) -> None:
    assert "uses of a picture compared" in rows["unplugging"]


def test_cameras_that_are_not_well(rows: dict[str, str]) -> None:
    assert "6 faults" in rows["ailing"]
