"""The page's routes."""

import os
from collections.abc import Awaitable, Callable
from pathlib import Path

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

import mocapd
from mocapd.web.answers import answer, json_answer, read_request
from mocapd.web.editor_lease import EditorLease
from mocapd.web.encoder import PictureEncoder
from mocapd.web.games.frames_access import PATH as FRAMES_PATH
from mocapd.web.games.frames_access import FramesAccess
from mocapd.web.games.frames_link import MOST_GAMES, FramesLink
from mocapd.web.host import Host
from mocapd.web.links.live_link import LiveLink
from mocapd.web.links.picture_link import picture_link
from mocapd.web.links.recording_link import RecordingLink
from mocapd.web.links.wizard_link import WizardLink
from mocapd.web.metrics_access import PATH as METRICS_PATH
from mocapd.web.recording_routes import RecordingRoutes
from mocapd.web.status_page import SetupAnswer, SetupRequest, Status

PAGE_DIR = Path(__file__).with_name("page")
# explicit, because systems map suffixes differently, and nosniff is strict about scripts
MEDIA_TYPES = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".svg": "image/svg+xml",
    ".png": "image/png",
}
MOST_SOCKETS = 24  # WebSockets at once; a window has three
_PNG = b"\x89PNG"


def make_app(
    host: Host,
    encoder: PictureEncoder,
    frames: FramesAccess | None = None,
    with_metrics: bool = False,
) -> Starlette:
    """The routes; `access` has authorised their requests."""
    made = _Routes(host, encoder, frames or FramesAccess())
    routes = made.routes()
    if with_metrics:
        routes.append(Route(METRICS_PATH, made.metrics))
    return Starlette(routes=routes)


class _Routes:
    def __init__(self, host: Host, encoder: PictureEncoder, frames: FramesAccess) -> None:
        self._host, self._encoder, self._frames_access = host, encoder, frames
        self._lease = EditorLease()
        self._sockets = 0  # open WebSockets of our own page
        self._games = 0  # and of allowed sites, which have a limit of their own
        # loaded now: no path is ever built from a request
        self._files = {
            path.name: (path.read_bytes(), MEDIA_TYPES[path.suffix])
            for path in PAGE_DIR.iterdir()
            if path.suffix in MEDIA_TYPES
        }

    def routes(self) -> list[Route | WebSocketRoute]:
        return [
            Route("/", self._index),
            Route("/page/{name}", self._file),
            Route("/picture/{key:path}", self._picture),
            Route("/status", self._status),
            Route("/setup", self._setup, methods=["POST"]),
            *RecordingRoutes(self._host).routes(),
            WebSocketRoute("/ws", self._wizard_link),
            WebSocketRoute("/pictures", self._pictures),
            WebSocketRoute("/live", self._live),
            WebSocketRoute("/recording", self._recording),
            WebSocketRoute(FRAMES_PATH, self._frames),
        ]

    async def _index(self, _request: Request) -> Response:
        return self._page_file("index.html")

    async def _file(self, request: Request) -> Response:
        return self._page_file(request.path_params["name"])

    def _page_file(self, name: str) -> Response:
        if name not in self._files:
            return PlainTextResponse("no such file", 404)
        data, media_type = self._files[name]
        return Response(data, media_type=media_type)

    async def _picture(self, request: Request) -> Response:
        wizard = self._host.wizard
        data = wizard.picture(request.path_params["key"]) if wizard is not None else None
        if data is None:
            return PlainTextResponse("no such picture any more", 404)
        return Response(data, media_type="image/png" if data[:4] == _PNG else "image/jpeg")

    async def _status(self, _request: Request) -> Response:
        host = self._host
        wizard, hub = host.wizard, host.hub
        return json_answer(
            Status(
                version=mocapd.__version__,
                pid=os.getpid(),
                cameras=hub.names if hub is not None else (),
                setup=wizard.view().step.value if wizard is not None else None,
                tracks=host.snapshot() is not None,
                origins=self._frames_access.origins,
                frames_key=self._frames_access.key,
            )
        )

    async def _setup(self, request: Request) -> Response:
        """Start a setup, or continue the current one; with {step}, at that step."""
        asked = await read_request(request, SetupRequest, b"{}")

        def start() -> Response:
            wizard = self._host.setup()
            if asked.step is not None:
                wizard.send("go", {"step": asked.step})
            return json_answer(SetupAnswer())

        return await answer(start)

    async def metrics(self, _request: Request) -> Response:
        # imported here: it takes a tenth of a second, and few users need it
        from mocapd.web.metrics_text import MEDIA_TYPE, metrics_text

        return Response(
            await run_in_threadpool(lambda: metrics_text(self._host.snapshot())),
            media_type=MEDIA_TYPE,
        )

    async def _wizard_link(self, socket: WebSocket) -> None:
        await self._if_room(socket, WizardLink(socket, self._host, self._lease).run)

    async def _pictures(self, socket: WebSocket) -> None:
        await self._if_room(socket, lambda: picture_link(socket, self._host, self._encoder))

    async def _live(self, socket: WebSocket) -> None:
        await self._if_room(socket, LiveLink(socket, self._host).run)

    async def _recording(self, socket: WebSocket) -> None:
        await self._if_room(socket, RecordingLink(socket, self._host, self._encoder.executor).run)

    async def _frames(self, socket: WebSocket) -> None:
        if self._games >= MOST_GAMES:
            await socket.send_denial_response(PlainTextResponse("too many games", 503))
            return
        self._games += 1
        try:
            await FramesLink(socket, self._host).run()
        finally:
            self._games -= 1

    async def _if_room(self, socket: WebSocket, run: Callable[[], Awaitable[None]]) -> None:
        if self._sockets >= MOST_SOCKETS:
            await socket.send_denial_response(PlainTextResponse("too many windows", 503))
            return
        self._sockets += 1
        try:
            await run()
        finally:
            self._sockets -= 1
