"""What is at which address of the page."""

import os
from pathlib import Path

import msgspec
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

import mocapd
from mocapd.errors import UnavailableError
from mocapd.web.encoder import PictureEncoder
from mocapd.web.host import Host
from mocapd.web.live_link import LiveLink
from mocapd.web.picture_link import picture_link
from mocapd.web.seat import Seat
from mocapd.web.status import SetupAnswer, SetupRequest, Status
from mocapd.web.wizard_link import WizardLink

PAGE_DIR = Path(__file__).with_name("page")
# given here, as what the system believes of a suffix differs, and nosniff is strict about scripts
MEDIA_TYPES = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".svg": "image/svg+xml",
    ".png": "image/png",
}
_PNG = b"\x89PNG"


def make_app(host: Host, encoder: PictureEncoder) -> Starlette:
    """The routes; who may use them is decided before (see access)."""
    return Starlette(routes=_Routes(host, encoder).routes())


class _Routes:
    def __init__(self, host: Host, encoder: PictureEncoder) -> None:
        self._host, self._encoder = host, encoder
        self._seat = Seat()

    def routes(self) -> list[Route | WebSocketRoute]:
        return [
            Route("/", self._index),
            Route("/page/{name}", self._file),
            Route("/picture/{key:path}", self._picture),
            Route("/status", self._status),
            Route("/setup", self._setup, methods=["POST"]),
            WebSocketRoute("/ws", self._wizard_link),
            WebSocketRoute("/pictures", self._pictures),
            WebSocketRoute("/live", self._live),
        ]

    async def _index(self, _request: Request) -> Response:
        return FileResponse(PAGE_DIR / "index.html", media_type=MEDIA_TYPES[".html"])

    async def _file(self, request: Request) -> Response:
        path = PAGE_DIR / request.path_params["name"]  # one part of a path: the route's own rule
        if path.suffix not in MEDIA_TYPES or not path.is_file():
            return PlainTextResponse("no such file", 404)
        return FileResponse(path, media_type=MEDIA_TYPES[path.suffix])

    async def _picture(self, request: Request) -> Response:
        wizard = self._host.wizard
        data = wizard.picture(request.path_params["key"]) if wizard is not None else None
        if data is None:
            return PlainTextResponse("no such picture any more", 404)
        return Response(data, media_type="image/png" if data[:4] == _PNG else "image/jpeg")

    async def _status(self, _request: Request) -> Response:
        host = self._host
        wizard, hub = host.wizard, host.hub
        return _json(
            Status(
                version=mocapd.__version__,
                pid=os.getpid(),
                cameras=hub.names if hub is not None else (),
                setup=wizard.view().step.value if wizard is not None else None,
                tracks=host.snapshot() is not None,
            )
        )

    async def _setup(self, request: Request) -> Response:
        """Begin a setup, or go on with the one there is; with {step}, at that step."""
        try:
            asked = msgspec.json.decode(await request.body() or b"{}", type=SetupRequest)
        except msgspec.DecodeError as error:
            return PlainTextResponse(f"not understood: {error}", 400)
        try:
            wizard = await run_in_threadpool(self._host.setup)
        except UnavailableError as error:
            return _json(SetupAnswer(error.what, error.where, error.fix), 503)
        if asked.step is not None:
            wizard.send("go", {"step": asked.step})
        return _json(SetupAnswer())

    async def _wizard_link(self, socket: WebSocket) -> None:
        await WizardLink(socket, self._host, self._seat).run()

    async def _pictures(self, socket: WebSocket) -> None:
        await picture_link(socket, self._host, self._encoder)

    async def _live(self, socket: WebSocket) -> None:
        await LiveLink(socket, self._host).run()


def _json(answer: object, status: int = 200) -> Response:
    return Response(msgspec.json.encode(answer), status, media_type="application/json")
