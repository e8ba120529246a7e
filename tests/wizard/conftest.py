"""What the tests of the steps share: boards that are looked for once in each picture."""

from collections.abc import Iterator

import pytest

from tests.calibrate.seen_once import seen_once


@pytest.fixture(scope="module", autouse=True)
def boards_seen_once() -> Iterator[None]:
    """The same pictures are shown for many ticks, and in many tests."""
    with seen_once():
        yield
