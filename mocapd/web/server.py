"""The web server: uvicorn in a thread of its own, on 127.0.0.1 only."""

import asyncio
import logging
import os
import secrets
import socket
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import uvicorn
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.protocols.utils import ClientDisconnected

from mocapd.config.web_params import Params
from mocapd.errors import UnavailableError
from mocapd.outputs.socket_owners import holder_of
from mocapd.web.access import Access
from mocapd.web.app import make_app
from mocapd.web.connections import (
    ACCEPTED_AT_ONCE,
    LONGEST_HEAD,
    QUEUE,
    HttpConnection,
    SocketConnection,
)
from mocapd.web.encoder import PictureEncoder
from mocapd.web.games.frames_access import frames_access
from mocapd.web.host import Host
from mocapd.web.links.socket_link import LONGEST_MESSAGE
from mocapd.web.log_limit import limit_logs
from mocapd.web.metrics_access import FILE_NAME as METRICS_KEY
from mocapd.web.metrics_access import PATH as METRICS_PATH
from mocapd.web.metrics_access import metrics_access
from mocapd.web.runtime_file import ADDRESS, Place, announce, redirect_file, url_of, withdraw

_log = logging.getLogger(__name__)

STOP_S = 1.4  # timeout of `stop`: uvicorn polls every 0.1 s, and gives its sockets 1 s [s]


class WebServer:
    """Serves the page from `start` to `stop`, or as a context manager.

    `died` is called in the server's thread with an unexpected exception. `place`: where to announce the
    URL (see runtime_file), or None. `encoder` counts its pictures.
    """

    def __init__(
        self,
        host: Host,
        params: Params,
        died: Callable[[BaseException], None],
        place: Place | None = None,
    ) -> None:
        self._host, self._port, self._died = host, params.port, died
        self._origins, self._with_metrics = params.allow_origins, params.metrics
        self._place = place
        self._token = secrets.token_urlsafe(24)
        self._executor = ThreadPoolExecutor(1, thread_name_prefix="web-encode")
        self.encoder = PictureEncoder(lambda: host.hub, self._executor, host.body)
        self._server: uvicorn.Server | None = None
        self._thread: threading.Thread | None = None

    def __enter__(self) -> "WebServer":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def port(self) -> int:
        """The TCP port; valid once started."""
        return self._port

    @property
    def url(self) -> str:
        """The page's URL with the token of this start; valid once started."""
        return url_of(self._port, self._token)

    @property
    def redirect(self) -> Path | None:
        """A file that redirects our user's browser to the page; None without an announcement."""
        return None if self._place is None else redirect_file(self._place.folder, os.getpid())

    def start(self) -> None:
        """Start; returns as soon as the page answers.

        Raises UnavailableError for a taken port, CannotCreateError when the URL cannot be announced, and as
        `frames_access` and `metrics_access`.
        """
        state_dir = None if self._place is None else self._place.state_dir
        frames = frames_access(self._origins, state_dir)
        metrics = metrics_access(self._with_metrics, state_dir)
        listening = _open_listener(self._port)
        self._port = listening.getsockname()[1]
        limit_logs()
        routes = make_app(self._host, self.encoder, frames, metrics.enabled)
        app = Access(routes, self._port, self._token, frames, metrics)
        config = uvicorn.Config(
            _Deadly(app, self._died),
            loop="asyncio",
            http=HttpConnection,
            ws=SocketConnection,
            lifespan="off",
            log_config=None,
            log_level="warning",
            access_log=False,  # URLs hold the token
            server_header=False,
            proxy_headers=False,
            backlog=ACCEPTED_AT_ONCE,
            h11_max_incomplete_event_size=LONGEST_HEAD,
            ws_max_size=LONGEST_MESSAGE,
            ws_ping_interval=None,  # on one machine the system closes the socket of a browser that has gone
            ws_per_message_deflate=False,  # JPEG does not get any smaller
            timeout_graceful_shutdown=1,
        )
        self._server = _Server(config)
        try:
            if self._place is not None:
                announce(self._place, self._port, self._token)
        except BaseException:
            listening.close()
            raise
        # a daemon thread: a browser that does not read must not keep the process from ending
        if metrics.enabled and state_dir is not None:
            _log.info(
                "figures for Prometheus at http://%s:%d%s, with the key in %s",
                *(ADDRESS, self._port, METRICS_PATH, state_dir / METRICS_KEY),
            )
        self._thread = threading.Thread(
            target=self._run, args=(self._server, listening), name="web", daemon=True
        )
        self._thread.start()

    def let_go(self) -> None:
        """First phase of stopping: withdraw the announcement, accept no new page, notify the open ones; never blocks."""
        if self._place is not None:
            withdraw(self._place.folder)
        if self._server is not None:
            self._server.should_exit = True

    def stop(self, timeout_s: float = STOP_S) -> bool:
        """End and join; False when the thread is still blocked after `timeout_s` [s]."""
        self.let_go()
        if self._thread is None:
            return True
        self._thread.join(timeout_s)
        self._executor.shutdown(wait=False, cancel_futures=True)
        return not self._thread.is_alive()

    def _run(self, server: uvicorn.Server, listening: socket.socket) -> None:
        try:
            # in this thread uvicorn installs no signal handlers
            server.run(sockets=[listening])
        except BaseException as error:
            self._died(error)
            raise


class _Server(uvicorn.Server):
    """With a backlog longer than the number of connections accepted at once."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(QUEUE)


class _Deadly:
    """ASGI middleware that reports unexpected errors to `died`: uvicorn would log them and continue."""

    def __init__(self, app: ASGIApp, died: Callable[[BaseException], None]) -> None:
        self._app, self._died = app, died

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await self._app(scope, receive, send)
        except (asyncio.CancelledError, ClientDisconnect, ClientDisconnected):  # the page has left
            raise
        except BaseException as error:
            self._died(error)
            raise


def _open_listener(port: int) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((ADDRESS, port))
        listening.listen(64)
    except OSError as error:
        listening.close()
        holder = holder_of(port) if port else ""
        raise UnavailableError(
            f"port {port} cannot be had: {error.strerror}"
            + (f", {holder} has it" if holder else ""),
            "web.port",
            "choose another port, or 0 for any free one",
        ) from error
    return listening
