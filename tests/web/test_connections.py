"""Connections that say nothing, little, or do not read: they keep nobody out, and end."""

import logging
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress

import pytest

from mocapd.web import connections
from mocapd.web.connections import MOST
from mocapd.web.log_limit import LogLimit
from mocapd.web.server import WebServer
from tests.cli.own_time import own_time
from tests.web.browser import PATIENCE_S, Window, connect, get, origin_of, token_of
from tests.web.tiny_host import TinyHost

NEWCOMER_S = 3.0


@contextmanager
def silent(server: WebServer, count: int, says: bytes = b"") -> Iterator[list[socket.socket]]:
    """So many connections that say this and no more; closed at the end."""
    with ExitStack() as opened:
        made = []
        for _ in range(count):
            one = opened.enter_context(socket.create_connection(("127.0.0.1", server.port)))
            one.sendall(says)
            made.append(one)
        yield made


@contextmanager
def unread(server: WebServer, says: bytes) -> Iterator[socket.socket]:
    """A connection that says this, and of whose answers the system keeps few."""
    with socket.socket() as one:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        one.settimeout(PATIENCE_S)
        one.connect(("127.0.0.1", server.port))
        one.sendall(says)
        yield one


def ends(one: socket.socket, says: bytes) -> bool:
    """Whether it is closed while it goes on saying this."""
    until_s = time.monotonic() + PATIENCE_S
    with suppress(ConnectionError):
        while time.monotonic() < until_s:
            one.sendall(says)
            time.sleep(0.001)
    return time.monotonic() < until_s


def is_closed(one: socket.socket) -> bool:
    one.setblocking(False)
    try:
        return one.recv(1) == b""
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def test_a_newcomer_is_served_while_300_say_nothing(host: TinyHost, server: WebServer) -> None:
    window = Window(server)
    window.wait(bool)
    with silent(server, 300) as them:
        took_s = own_time()
        assert get(server, "/status", token=token_of(server)).status_code == 200
        with connect(server, "/live") as page:
            page.recv(PATIENCE_S)
            assert took_s() < NEWCOMER_S
            assert sum(not is_closed(one) for one in them) <= MOST
        window.do("begin")  # who was there before still is
        assert window.wait(lambda view: view["setup"])["driver"] is True
    window.close()


@pytest.mark.parametrize(
    "says",
    [
        b"",
        b"GET / HTTP/1.1\r\nHost: x\r\n",
        b"POST /setup HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nab",
        b"GET / HTTP/1.1\r\nHost: x\r\n\r\nPOST / HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\n",
    ],
    ids=["nothing", "half its headers", "half a body", "one and a half"],
)
def test_who_does_not_finish_a_request_is_closed(
    server: WebServer, monkeypatch: pytest.MonkeyPatch, says: bytes
) -> None:
    monkeypatch.setattr(connections, "REQUEST_S", 0.2)
    with silent(server, 3, says) as them:
        for one in them:
            one.settimeout(PATIENCE_S)
            with suppress(ConnectionError):
                while one.recv(65536):
                    pass


def test_a_byte_now_and_then_does_not_help(
    server: WebServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "REQUEST_S", 0.3)
    with silent(server, 1, b"GET / HTTP/1.1\r\nx: ") as (one,):
        assert ends(one, b"y")


def test_a_slow_but_whole_request_is_answered(server: WebServer) -> None:
    head = f"GET /status?token={token_of(server)} HTTP/1.1\r\nHost: {origin_of(server)[7:]}\r\n"
    with silent(server, 1, head.encode()) as (one,):
        time.sleep(0.3)
        one.sendall(b"\r\n")
        one.settimeout(PATIENCE_S)
        assert one.recv(4096).startswith(b"HTTP/1.1 200")


def test_a_window_that_does_not_read_is_closed(
    server: WebServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It goes on sending pings, whose answers it does not read either."""
    monkeypatch.setattr(connections, "STALLED_S", 0.5)
    head = f"GET /pictures?token={token_of(server)} HTTP/1.1\r\nHost: {origin_of(server)[7:]}\r\n"
    head += "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    head += f"Sec-WebSocket-Key: {22 * 'A'}==\r\n\r\n"
    with unread(server, head.encode()) as page:
        ping = bytes([0x89, 0x80 | 125, 0, 0, 0, 0]) + 125 * b"x"
        assert ends(page, 100 * ping)
    assert get(server, "/status", token=token_of(server)).status_code == 200


def test_who_asks_and_does_not_read_is_closed(
    server: WebServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "STALLED_S", 0.5)
    head = f"GET /page/style.css?token={token_of(server)} HTTP/1.1\r\n"
    request = f"{head}Host: {origin_of(server)[7:]}\r\n\r\n".encode()
    with unread(server, request) as page:
        assert ends(page, request)
    assert get(server, "/status", token=token_of(server)).status_code == 200


def test_a_log_has_each_message_once_in_a_while_and_the_rest_counted(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    logger = logging.getLogger("tests.log_limit")
    now_s = 100.0
    monkeypatch.setattr("mocapd.web.log_limit.time.monotonic", lambda: now_s)
    logger.addFilter(LogLimit())
    for i in range(1000):
        logger.error(f"socket.accept() out of system resource\nsocket: <{i}>")
    logger.error("another")
    now_s += 11.0
    logger.error("socket.accept() out of system resource\nsocket: <7>")
    for i in range(1000):
        logger.error(f"many kinds {i}")  # do not fill the memory either
    told = [record.getMessage() for record in caplog.records]
    assert len(told) == 1003
    assert told[1] == "another"
    assert "999 more" in told[2]
    (limit,) = logger.filters
    assert isinstance(limit, LogLimit)
    logger.removeFilter(limit)


def test_asyncio_and_uvicorn_are_limited(server: WebServer) -> None:
    for name in ("asyncio", "uvicorn.error"):
        assert [type(one) for one in logging.getLogger(name).filters] == [LogLimit]
