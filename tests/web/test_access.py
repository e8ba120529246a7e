"""Who is let in: the token, our own address, and no other site."""

from collections.abc import Mapping

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from mocapd.web.access import HEADERS
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, connect, get, origin_of, token_of

SOCKETS = ("/ws", "/pictures", "/live")


def cookie_of(answer: httpx.Response) -> str:
    return answer.headers["set-cookie"].partition(";")[0]


def test_the_printed_url_opens_the_page(server: WebServer) -> None:
    answer = httpx.get(server.url, trust_env=False, timeout=PATIENCE_S)
    assert answer.status_code == 200
    assert "<title>mocapd</title>" in answer.text


def test_the_first_page_leaves_a_cookie_that_lets_in_without_token(server: WebServer) -> None:
    first = get(server, "/", token=token_of(server))
    flags = first.headers["set-cookie"]
    assert "HttpOnly" in flags
    assert "SameSite=Strict" in flags
    assert str(server.port) in cookie_of(first)
    later = get(server, "/status", {"cookie": cookie_of(first)})
    assert later.status_code == 200


@pytest.mark.parametrize("token", ["", "wrong", "ü", "x" * 5000])
def test_a_wrong_token_is_refused_and_told_what_to_do(server: WebServer, token: str) -> None:
    answer = get(server, "/", token=token)
    assert answer.status_code == 401
    assert "mocapd calibrate" in answer.text
    assert "set-cookie" not in answer.headers
    assert token_of(server) not in answer.text


def test_a_cookie_of_another_start_is_refused(server: WebServer) -> None:
    cookie = cookie_of(get(server, "/", token=token_of(server)))
    stale = cookie.replace(token_of(server), "of-the-start-before")
    assert get(server, "/status", {"cookie": stale}).status_code == 401


def test_a_foreign_host_is_refused_despite_the_token(server: WebServer) -> None:
    """As after DNS rebinding: evil.example points to 127.0.0.1."""
    for name in (f"evil.example:{server.port}", "127.0.0.1", "127.0.0.1:1"):
        answer = get(server, "/", {"host": name}, token=token_of(server))
        assert answer.status_code == 403, name


def test_localhost_is_our_host_too(server: WebServer) -> None:
    headers = {"host": f"localhost:{server.port}", "origin": f"http://localhost:{server.port}"}
    assert get(server, "/", headers, token=token_of(server)).status_code == 200


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
        ("/", True, {}, 200),
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
