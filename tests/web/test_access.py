"""Who is let in: the token, our own address, and no other site."""

import logging
from collections.abc import Mapping
from urllib.parse import urlsplit

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from mocapd.config.web_params import Params
from mocapd.web.access import HEADERS
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, connect, get, origin_of, token_of
from tests.web.tiny_host import TinyHost

SOCKETS = ("/ws", "/pictures", "/live", "/recording")


def cookie_of(answer: httpx.Response) -> str:
    return answer.headers["set-cookie"].partition(";")[0]


def test_the_printed_url_opens_the_page(server: WebServer) -> None:
    answer = httpx.get(server.url, trust_env=False, timeout=PATIENCE_S, follow_redirects=True)
    assert answer.status_code == 200
    assert "<title>mocapd</title>" in answer.text


def entered(server: WebServer, host: str = "127.0.0.1") -> tuple[str, httpx.Response]:
    """The page's place, which `/` leads to, and its first answer."""
    headers = {"host": f"{host}:{server.port}"}
    door = get(server, "/", headers, token=token_of(server))
    assert door.status_code == 303
    place = urlsplit(door.headers["location"]).path
    return place, get(server, place, headers, token=token_of(server))


def test_the_first_page_leaves_a_cookie_that_lets_in_without_token(server: WebServer) -> None:
    place, first = entered(server)
    flags = first.headers["set-cookie"]
    assert "HttpOnly" in flags
    assert "SameSite=Strict" in flags
    assert str(server.port) in cookie_of(first)
    for path in ("", "status", "page/app.js"):
        assert get(server, place + path, {"cookie": cookie_of(first)}).status_code == 200


def test_the_cookie_is_for_the_pages_own_place_and_is_not_the_token(server: WebServer) -> None:
    """Browsers send cookies to all ports of 127.0.0.1: what another server is sent must not help it."""
    place, first = entered(server)
    assert f"Path={place};" in first.headers["set-cookie"] + ";"
    assert len(place) > 12
    assert token_of(server) not in first.headers["set-cookie"]
    assert token_of(server) not in place
    for path in ("/", "/status", "/page/app.js", place.rstrip("/")):
        assert get(server, path, {"cookie": cookie_of(first)}).status_code == 401, path
    secret = cookie_of(first).partition("=")[2]
    assert get(server, "/", token=secret).status_code == 401


def test_each_start_has_a_place_of_its_own(server: WebServer, host: TinyHost) -> None:
    with WebServer(host, Params(), lambda error: None) as other:
        place, first = entered(server)
        other_place, _ = entered(other)
        assert place != other_place
        assert get(other, place, {"cookie": cookie_of(first)}).status_code == 401


@pytest.mark.parametrize("token", ["", "wrong", "ü", "x" * 5000])
def test_a_wrong_token_is_refused_and_told_what_to_do(server: WebServer, token: str) -> None:
    answer = get(server, "/", token=token)
    assert answer.status_code == 401
    assert "mocapd calibrate" in answer.text
    assert "set-cookie" not in answer.headers
    assert token_of(server) not in answer.text


def test_a_cookie_of_another_start_is_refused(server: WebServer) -> None:
    place, first = entered(server)
    name, _, _ = cookie_of(first).partition("=")
    stale = f"{name}=of-the-start-before"
    assert get(server, f"{place}status", {"cookie": stale}).status_code == 401


def test_a_foreign_host_is_refused_despite_the_token(server: WebServer) -> None:
    """As after DNS rebinding: evil.example points to 127.0.0.1."""
    for name in (f"evil.example:{server.port}", "127.0.0.1", "127.0.0.1:1"):
        answer = get(server, "/", {"host": name}, token=token_of(server))
        assert answer.status_code == 403, name


def test_localhost_is_our_host_too(server: WebServer) -> None:
    place, first = entered(server, "localhost")
    assert first.status_code == 200
    headers = {"host": f"localhost:{server.port}", "origin": f"http://localhost:{server.port}"}
    headers["cookie"] = cookie_of(first)
    assert get(server, f"{place}status", headers).status_code == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1"])
def test_a_foreign_origin_is_refused_despite_the_token(server: WebServer, origin: str) -> None:
    answer = get(server, "/status", {"origin": origin}, token=token_of(server))
    assert answer.status_code == 403
    assert "access-control-allow-origin" not in answer.headers


@pytest.mark.parametrize("path", SOCKETS)
def test_websockets_are_guarded_likewise(server: WebServer, path: str) -> None:
    with connect(server, path):
        pass
    for refused, status in (
        ({"token": "wrong"}, 401),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": f"https://127.0.0.1:{server.port}"}, 403),
    ):
        with pytest.raises(InvalidStatus) as caught, connect(server, path, **refused):
            pass
        assert caught.value.response.status_code == status


@pytest.mark.parametrize(
    ("path", "query", "headers", "status"),
    [
        ("/", True, {}, 303),
        ("/page/style.css", True, {}, 200),
        ("/page/none.js", True, {}, 404),
        ("/picture/none", True, {}, 404),
        ("/nowhere", True, {}, 404),
        ("/", False, {}, 401),
        ("/", True, {"origin": "http://evil.example"}, 403),
    ],
)
def test_every_answer_has_the_protecting_headers(
    server: WebServer, path: str, query: bool, headers: Mapping[str, str], status: int
) -> None:
    token = {"token": token_of(server)} if query else {}
    answer = get(server, path, headers, **token)
    assert answer.status_code == status
    for name, value in HEADERS.items():
        assert answer.headers[name] == value
    policy = answer.headers["content-security-policy"]
    assert "default-src 'self'" in policy
    assert "unsafe" not in policy


def test_only_this_machine_is_listened_to(server: WebServer) -> None:
    assert origin_of(server).startswith("http://127.0.0.1:")


def test_other_sites_and_names_are_logged_once_each_a_stale_window_never(
    server: WebServer, caplog: pytest.LogCaptureFixture
) -> None:
    for _ in range(3):
        assert get(server, "/", token="of-another-start").status_code == 401
        assert get(server, "/", {"origin": "http://evil.example"}).status_code == 403
        assert get(server, "/", {"host": "rebound.example\t" + "x" * 5000}).status_code == 403
    site, name = [one for one in caplog.messages if "refused" in one]
    assert "Origin 'http://evil.example'" in site
    assert "Host 'rebound.example\\t" in name
    assert len(name) < 400


@pytest.mark.parametrize("path", SOCKETS)
def test_strangers_whose_websocket_is_refused_are_no_trouble_of_the_log(
    server: WebServer, path: str, caplog: pytest.LogCaptureFixture
) -> None:
    with pytest.raises(InvalidStatus), connect(server, path, token="guess"):
        pass
    assert get(server, "/status", token=token_of(server)).status_code == 200
    assert [one.getMessage() for one in caplog.records if one.levelno >= logging.WARNING] == []
