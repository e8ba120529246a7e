"""Start and stop: ports, the announcement, and an end that open pages cannot delay."""

import os
import socket
from contextlib import suppress
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

from mocapd.config.web_params import Params
from mocapd.errors import CannotCreateError, UnavailableError
from mocapd.web.runtime_file import Place
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, connect, until_closed
from tests.web.tiny_host import TinyHost


def test_it_ends_in_time_although_pages_are_open(host: TinyHost) -> None:
    died: list[BaseException] = []
    server = WebServer(host, Params(), died.append)
    server.start()
    host.setup()
    host.show("cam0", 1)
    with (
        connect(server, "/ws") as setup,
        connect(server, "/live") as live,
        connect(server, "/pictures") as pictures,
        socket.create_connection(("127.0.0.1", server.port)),  # says nothing
    ):
        pictures.send('{"camera": "cam0"}')
        pictures.send('{"camera": "cam1"}')  # has no picture: this one waits
        assert server.stop()
        for page in (setup, live, pictures):
            with pytest.raises(ConnectionClosed):
                until_closed(page)
    assert died == []


def test_a_page_that_does_not_read_cannot_delay_the_end(host: TinyHost) -> None:
    server = WebServer(host, Params(), lambda error: None)
    server.start()
    with connect(server, "/live") as page:
        page.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        assert server.stop()


def test_a_message_that_is_too_long_ends_that_page_only(host: TinyHost, server: WebServer) -> None:
    for path in ("/ws", "/live", "/pictures"):
        with connect(server, path) as page:
            with suppress(ConnectionClosed):  # it may be closed while we still send
                page.send("x" * (9 << 20))
            with pytest.raises(ConnectionClosed):
                until_closed(page)
    with connect(server, "/live") as page:
        page.recv(PATIENCE_S)


def test_pages_that_come_and_go_leave_nothing_behind(host: TinyHost, server: WebServer) -> None:
    """In the midst of messages in both directions."""
    host.setup()
    for seq in range(20):
        host.show("cam0", seq)
        for path in ("/ws", "/live", "/pictures"):
            with connect(server, path) as page:
                page.send('{"camera": "cam0"}' if path == "/pictures" else '{"watch": true}')
                page.socket.shutdown(socket.SHUT_RDWR)
    with connect(server, "/live") as page:
        page.recv(PATIENCE_S)


def test_each_start_has_its_own_token(host: TinyHost) -> None:
    urls = {WebServer(host, Params(), lambda error: None).url for _ in range(3)}
    assert len(urls) == 3


def test_a_taken_port_is_told(host: TinyHost, server: WebServer) -> None:
    other = WebServer(host, Params(port=server.port), lambda error: None)
    with pytest.raises(UnavailableError, match=str(server.port)) as caught:
        other.start()
    assert caught.value.where == "web.port"
    assert str(os.getpid()) in caught.value.what
    assert other.stop()


def test_what_nobody_expected_is_told_to_the_owner(host: TinyHost) -> None:
    died: list[BaseException] = []
    with WebServer(host, Params(), died.append) as server:
        host.snapshot = lambda: 1 / 0  # type: ignore[assignment, return-value]
        with connect(server, "/live") as page, pytest.raises(ConnectionClosed):
            until_closed(page)
    assert isinstance(died[0], ZeroDivisionError)


def test_a_place_that_cannot_be_written_is_told(host: TinyHost, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    server = WebServer(host, Params(), lambda error: None, Place(blocked / "run", tmp_path))
    with pytest.raises(CannotCreateError):
        server.start()
    assert server.stop()
