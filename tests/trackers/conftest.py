"""What the tests of the colour tracker share: a small pose database, built once."""

import pytest

from mocapd.shirt.pose_database.database import DatabaseParams, PoseDatabase, build_database


@pytest.fixture(scope="session")
def pose_database() -> PoseDatabase:
    return build_database(DatabaseParams(count=3000, pool=1.2, cells=32))
