"""A real server on a free port, whose cameras and setup the test has in hand."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from mocapd.config.web_params import Params
from mocapd.web.server import WebServer
from tests.web.tiny_host import TinyHost


@pytest.fixture
def host(tmp_path: Path) -> Iterator[TinyHost]:
    """Two cameras without pictures yet, no setup."""
    tiny = TinyHost(tmp_path)
    yield tiny
    tiny.stop()


@pytest.fixture
def server(host: TinyHost) -> Iterator[WebServer]:
    """Serves `host`; nothing unexpected may have happened in it."""
    died: list[BaseException] = []
    with WebServer(host, Params(), died.append) as one:
        yield one
    assert died == []
