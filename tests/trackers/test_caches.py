"""What is said of a cache that a tracker makes anew."""

from pathlib import Path

import pytest

from mocapd.shirt.pose_database import database_file
from mocapd.shirt.pose_database.cache_name import CACHE_NAME
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.pose_database.database_file import LoadedDatabase
from mocapd.trackers.registry import Resources, make_caches


@pytest.mark.parametrize(
    ("has_file", "is_beginning", "said"),
    [(True, False, ["it is old, so it was rebuilt"]), (True, True, []), (False, False, [])],
)
def test_only_the_whole_database_is_said_to_be_rebuilt(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    smaller_database: PoseDatabase,
    has_file: bool,
    is_beginning: bool,
    said: list[str],
) -> None:
    """An early start warned that the file of the beginning was missing, as it is in every early start."""
    for name in ("load_or_build", "load_or_build_beginning"):
        built = LoadedDatabase(smaller_database, built=True, reason="it is old")
        monkeypatch.setattr(database_file, name, lambda *_, made=built, **__: made)
    if has_file:
        (tmp_path / CACHE_NAME).touch()
    warnings: list[str] = []
    resources = Resources(tmp_path, warn=warnings.append, is_beginning=is_beginning)
    make_caches("shirt", resources)
    assert warnings == said
