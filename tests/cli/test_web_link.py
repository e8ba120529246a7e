"""`mocapd web-link` to a running page."""

from pathlib import Path

import pytest

from mocapd.cli.web_link import web_link
from mocapd.config.runtime_folder import runtime_folder
from mocapd.config.web_params import Params
from mocapd.errors import ConfigError, UnavailableError
from mocapd.web.runtime_file import Place
from mocapd.web.server import WebServer
from tests.web.tiny_host import TinyHost

SITE = "http://localhost:8000"


@pytest.fixture
def place(empty_home: Path) -> Place:
    return Place(runtime_folder(empty_home), empty_home, "pc")


def test_it_prints_one_address_for_each_site(
    place: Place, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(UnavailableError, match="no mocapd of yours"):
        web_link()
    host = TinyHost(tmp_path)
    with WebServer(host, Params(), lambda error: None, place), pytest.raises(ConfigError):
        web_link()
    params = Params(allow_origins=(SITE, "https://game.example"))
    broken = tmp_path / "config.toml"
    broken.write_text("nonsense = 1\n")
    with WebServer(host, params, lambda error: None, place) as server:
        web_link(broken)  # the daemon runs on what it read before
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{SITE}/#mocapd=ws://127.0.0.1:{server.port}/frames?key=")
    assert second.startswith("https://game.example/#mocapd=ws://")
