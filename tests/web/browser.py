"""What a browser does, without one: requests and WebSockets with the headers it would send."""

import json
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx
from websockets.sync.client import ClientConnection
from websockets.sync.client import connect as open_socket
from websockets.typing import Origin

from mocapd.web.server import WebServer

PATIENCE_S = 120.0  # before a test gives up waiting [s]


def origin_of(server: WebServer) -> str:
    """`http://127.0.0.1:port`"""
    return f"http://{urlsplit(server.url).netloc}"


def token_of(server: WebServer) -> str:
    return parse_qs(urlsplit(server.url).query)["token"][0]


def get(
    server: WebServer, path: str, headers: Mapping[str, str] | None = None, **query: str
) -> httpx.Response:
    """GET without a token, unless the query has one."""
    # without `verify` it would load the system's certificates each time
    return httpx.get(
        origin_of(server) + path,
        params=query,
        headers=dict(headers or {}),
        trust_env=False,
        verify=False,
        timeout=PATIENCE_S,
    )


def connect(
    server: WebServer, path: str, origin: str | None = None, token: str | None = None
) -> AbstractContextManager[ClientConnection]:
    """A WebSocket with the right token and our own origin, unless told otherwise: a context manager."""
    token = token_of(server) if token is None else token
    found: AbstractContextManager[ClientConnection] = open_socket(
        origin_of(server).replace("http", "ws") + f"{path}?token={token}",
        origin=Origin(origin_of(server) if origin is None else origin),
        proxy=None,
        open_timeout=PATIENCE_S,
    )
    return found


def until_closed(socket: ClientConnection) -> None:
    """Read what there still is. Raises ConnectionClosed, or TimeoutError."""
    while True:
        socket.recv(PATIENCE_S)


class Window:
    """A browser window with the setup: what it was shown last, and what the person does."""

    def __init__(self, server: WebServer) -> None:
        self._opened = ExitStack()
        self.socket = self._opened.enter_context(connect(server, "/ws"))
        self.view: dict[str, Any] = {}

    def wait(self, until: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The first view that is so."""
        while not until(self.view):
            self.view = json.loads(self.socket.recv(PATIENCE_S))
        return self.view

    def do(self, verb: str, **args: object) -> None:
        self.socket.send(json.dumps({"verb": verb, "args": args}))

    def close(self) -> None:
        self._opened.close()
