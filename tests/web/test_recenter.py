"""POST /recenter: for who may see the page, with the refusal's own words."""

from pathlib import Path

import httpx
import pytest

from mocapd.config.web_params import Params
from mocapd.errors import UnavailableError
from mocapd.web.runtime_file import Place, recenter, running
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, get, origin_of, token_of
from tests.web.tiny_host import TinyHost


def posted(server: WebServer, token: str, **headers: str) -> httpx.Response:
    url = f"{origin_of(server)}/recenter?token={token}"
    return httpx.post(url, headers=headers, trust_env=False, timeout=PATIENCE_S)


def test_another_process_of_this_user_may_say_it(host: TinyHost, tmp_path: Path) -> None:
    place = Place(tmp_path / "run", tmp_path, "game")
    with WebServer(host, Params(), lambda error: None, place):
        (found,) = running(place.folder)
        told = recenter(found.url)
        assert (told.yaw_deg, told.outputs) == (12.5, ("osc",))
        host.tracks = False
        with pytest.raises(UnavailableError, match=r"cam0: nobody is seen -- stand there"):
            recenter(found.url)


def test_nobody_else_may(server: WebServer) -> None:
    assert posted(server, token_of(server)).status_code == 200
    assert posted(server, "wrong").status_code == 401
    assert posted(server, token_of(server), origin="http://example.org").status_code == 403
    assert posted(server, token_of(server), host="example.org").status_code == 403
    assert get(server, "/recenter", token=token_of(server)).status_code == 405


def test_a_daemon_that_is_gone_is_a_named_error(server: WebServer) -> None:
    url = server.url
    server.stop()
    with pytest.raises(UnavailableError, match="the running daemon"):
        recenter(url)
