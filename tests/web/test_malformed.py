"""Requests and messages that nobody's page sends: each is refused, none ends the process."""

import json
import socket
import time
from contextlib import suppress
from urllib.parse import urlsplit

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from mocapd.web.answers import LONGEST_BODY
from mocapd.web.app import MOST_SOCKETS
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, Window, connect, get, origin_of, token_of, until_closed
from tests.web.tiny_host import TinyHost

DEEP = b'{"verb": "x", "args": {"a": ' + b"[" * 3000 + b"]" * 3000 + b"}}"
MESSAGES = [
    b"",
    b"{}",
    b"\xff\xfe",
    b'{"verb": "\xff"}',
    b'{"camera": "cam0", "width": 1000000000000000000000000000000}',
    b'{"camera": "cam0", "width": -1}',
    b'{"camera": "cam0", "width": 1e400}',
    b'{"camera": "cam0", "after": -5}',
    b'{"camera": "' + b"x" * 5000 + b'"}',
    ('{"camera": "cam0", "over": "' + 100 * "\u20ac" + '"}').encode(),
    ('{"watch": ' + "9" * 5000 + "}").encode(),
    b'{"verb": "' + b"x" * 5000 + b'"}',
    DEEP,
]


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message[:40].decode("latin-1"))
def test_a_message_that_is_not_understood_closes_its_connection_only(
    host: TinyHost, server: WebServer, message: bytes
) -> None:
    for path in ("/live", "/pictures"):
        with connect(server, path) as page:
            page.send(message)
            with pytest.raises(ConnectionClosed) as closed:
                until_closed(page)
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1007
    window = Window(server)
    window.socket.send(message)
    shown = window.wait(lambda view: bool(view) and view["refused"] is not None)
    assert "not understood" in shown["refused"]["what"]
    window.close()


@pytest.mark.parametrize(
    "body", [b"[]", b"\xff", b'{"step": "\xff"}', b'{"step": 1}', b"[" * 3000 + b"]" * 3000]
)
def test_a_body_that_is_not_understood_is_refused(server: WebServer, body: bytes) -> None:
    answer = posted(server, body)
    assert answer.status_code == 400
    assert "not understood" in answer.text


def test_a_body_that_is_too_long_is_refused_before_it_has_come(server: WebServer) -> None:
    assert posted(server, json.dumps({"step": "x" * LONGEST_BODY}).encode()).status_code == 413
    with socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) as one:
        head = (
            f"POST /setup?token={token_of(server)} HTTP/1.1\r\nHost: {urlsplit(server.url).netloc}"
        )
        one.sendall(f"{head}\r\nContent-Length: 1000000000\r\n\r\n".encode())
        one.sendall(b" " * (LONGEST_BODY + 1))
        assert b" 413 " in one.recv(4096).partition(b"\r\n")[0]


@pytest.mark.parametrize("token", [False, True])
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_body_that_is_no_http_ends_its_connection_only(
    server: WebServer, token: bool, method: str
) -> None:
    """Its request is being answered already; any process of the machine can send this."""
    query = f"?token={token_of(server)}" if token else ""
    head = f"{method} /setup{query} HTTP/1.1\r\nHost: {urlsplit(server.url).netloc}\r\n"
    for body in ("zz\r\n", "5\r\nabcdefgh\r\n", "f" * 30 + "\r\n"):
        for pause_s in (0.0, 0.05):
            with socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) as one:
                one.sendall(f"{head}Transfer-Encoding: chunked\r\n\r\n".encode() * 2)
                time.sleep(pause_s)
                one.sendall(body.encode())
                with suppress(ConnectionError):
                    while one.recv(4096):
                        pass
            with socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) as one:
                one.sendall(f"{head}Transfer-Encoding: chunked\r\n\r\n{body}".encode())
                assert one.recv(4096).startswith(b"HTTP/1.1 4")
    assert get(server, "/status", token=token_of(server)).status_code == 200


def test_an_address_that_is_too_long_is_refused(server: WebServer) -> None:
    for length in (9_000, 60_000):
        answer = get(server, "/" + "x" * length, token=token_of(server))
        assert answer.status_code in (400, 414)  # the former when it comes in several parts


def test_a_websocket_that_its_library_would_not_take_is_refused(
    server: WebServer, caplog: pytest.LogCaptureFixture
) -> None:
    upgrade = {"connection": "Upgrade", "upgrade": "websocket"}
    many = {f"x-{i}": "y" for i in range(150)}
    for headers in (upgrade | many, upgrade | {"x-long": "y" * 9000}):
        assert get(server, "/live", headers, token=token_of(server)).status_code == 400
    posts = httpx.post(server.url, headers=upgrade, trust_env=False, timeout=PATIENCE_S)
    assert posts.status_code in (400, 405)  # an older websockets library refuses it as a whole
    with socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) as one:
        one.sendall(b"GET / HTTP/1.1\r\nConnection: upgrade\r\nUpgrade: websocket\r\n")
        one.sendall(b"Host: x\r\nX-Y: \x01\r\n\r\n")
        assert one.recv(4096).startswith(b"HTTP/1.1 400")
    assert "Fatal error" not in caplog.text


def test_only_so_many_windows_at_once(host: TinyHost, server: WebServer) -> None:
    host.tracks = False  # what windows are shown takes long, and does not matter
    open_now = [connect(server, "/live") for _ in range(MOST_SOCKETS)]
    for one in open_now:
        one.__enter__()
    with pytest.raises(InvalidStatus) as refused, connect(server, "/live"):
        pass
    assert refused.value.response.status_code == 503
    open_now.pop().__exit__(None, None, None)
    with connect(server, "/live") as page:
        page.recv(PATIENCE_S)
    for one in open_now:
        one.__exit__(None, None, None)


def test_a_refusal_by_name_is_told_and_not_deadly(host: TinyHost, server: WebServer) -> None:
    host.why_not = "rtsp://admin:hunter2@10.0.0.9/live is lost"
    answer = posted(server, b"{}")
    assert answer.status_code == 503
    assert answer.json()["what"] == "rtsp://admin:***@10.0.0.9/live is lost"


def posted(server: WebServer, body: bytes) -> httpx.Response:
    return httpx.post(
        f"{origin_of(server)}/setup?token={token_of(server)}",
        content=body,
        trust_env=False,
        timeout=PATIENCE_S,
    )
