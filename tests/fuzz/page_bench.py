"""The page's ASGI app, asked without a socket, with a setup that is going on and two cameras."""

import asyncio
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import h11
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Scope

from mocapd.web.access import TOKEN, Access
from mocapd.web.app import make_app
from mocapd.web.encoder import PictureEncoder
from mocapd.web.games.frames_access import FramesAccess
from mocapd.web.links.socket_link import LONGEST_MESSAGE
from mocapd.wizard.wizard import Wizard
from tests.fuzz.setup_bench import SetupBench
from tests.fuzz.warp_loop import WarpLoop
from tests.web.tiny_host import TinyHost

PORT = 8080
SECRET = "N0t-really-a-token-but-as-long-as-one"
SITE = "https://game.example"
SITE_KEY = "that-of-the-frames-for-allowed-sites"
_ORIGIN = f"http://127.0.0.1:{PORT}"
_ANSWERS_S = 1.5  # how long a page waits before it leaves, by the loop's own clock


class Host(TinyHost):
    """With the real setup, which is always on."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.bench = SetupBench(folder)
        self.hub = self.bench.hub
        self.wizard = self.bench.wizard

    def setup(self) -> Wizard:
        """See Host."""
        return self.bench.wizard


@dataclass(frozen=True, slots=True)
class Answer:
    """status: 0 when nothing was answered."""

    status: int
    headers: Mapping[str, str]
    body: bytes


class PageBench:
    """A host and its page, made anew for each input; `base` and `cookie` are what a browser that was let in
    has. The loop and the app's own threads are shared by those of one process."""

    def __init__(self, folder: Path) -> None:
        self.loop, self.executor = _of_this_process()
        self.host = Host(folder)
        encoder = PictureEncoder(lambda: self.host.hub, self.executor)
        frames = FramesAccess((SITE,), SITE_KEY)
        self._app: ASGIApp = Access(make_app(self.host, encoder, frames), PORT, SECRET, frames)
        self.base, self.cookie = "", ""

    def let_in(self) -> None:
        """As a browser is that opens the printed address."""
        address = f"/?{TOKEN}={SECRET}"
        answer = self.ask(request("GET", address))
        while 300 <= answer.status < 400:  # to the place that the page has for itself
            address = answer.headers["location"]
            answer = self.ask(request("GET", address))
        assert answer.status == 200, f"not let in: {answer.status}"
        self.base = address.partition("?")[0].rstrip("/")
        self.cookie = answer.headers["set-cookie"].partition(";")[0]

    def ask(self, raw: bytes) -> Answer:
        """The answer to the bytes of a request; 400 where h11 does not take them, as uvicorn says then."""
        try:
            scope, body, whole = _taken_apart(raw)
        except h11.RemoteProtocolError:
            return Answer(400, {}, b"")
        return self.loop.run_until_complete(self._asked(scope, body, whole))

    async def _asked(self, scope: Scope, body: bytes, whole: bool) -> Answer:
        events: list[Message] = [{"type": "http.disconnect"}]
        events.insert(0, {"type": "http.request", "body": body, "more_body": not whole})
        said: list[Message] = []

        async def receive() -> Message:
            return events.pop(0) if len(events) > 1 else events[0]

        async def send(message: Message) -> None:
            said.append(message)

        try:
            await self._app(scope, receive, send)
        except ClientDisconnect:  # the request was not whole
            return Answer(0, {}, b"")
        start = next((one for one in said if one["type"] == "http.response.start"), None)
        if start is None:
            return Answer(0, {}, b"")
        headers = {
            name.decode("latin-1"): text.decode("latin-1") for name, text in start["headers"]
        }
        return Answer(start["status"], headers, b"".join(one.get("body", b"") for one in said))

    def talk(
        self, path: str, messages: Iterable[bytes], cookie: str, origin: str = _ORIGIN
    ) -> list[Message]:
        """Open a WebSocket, say these, wait a little, and leave: what was answered."""
        scope = _socket_scope(path, cookie, origin)
        return self.loop.run_until_complete(self._talked(scope, list(messages)))

    async def _talked(self, scope: Scope, messages: list[bytes]) -> list[Message]:
        events: list[Message] = [{"type": "websocket.connect"}]
        events += [_as_frame(one) for one in messages if len(one) <= LONGEST_MESSAGE]
        said: list[Message] = []

        async def receive() -> Message:
            if events:
                return events.pop(0)
            if not any(one["type"] == "websocket.close" for one in said):
                await asyncio.sleep(_ANSWERS_S)
            return {"type": "websocket.disconnect", "code": 1001}

        async def send(message: Message) -> None:
            said.append(message)

        await self._app(scope, receive, send)
        return said

    def settle(self) -> None:
        """Until the setup has dealt with all it was sent. Raises DeadlyError when that ended it."""
        bench, wizard = self.host.bench, self.host.bench.wizard
        if not wizard.sent:
            return
        wizard.send("wake up")
        serial = wizard.view().serial
        bench.newer(serial)
        bench.newer(serial + 1)

    def close(self) -> None:
        """End the setup."""
        self.host.bench.close()


@cache
def _of_this_process() -> tuple[WarpLoop, ThreadPoolExecutor]:
    """Made when it is asked for: a loop from before the fork would have its rows' processes take each other's
    wake-ups, and wait for ever."""
    return WarpLoop(), ThreadPoolExecutor(1)


def request(method: str, path: str, cookie: str = "", body: bytes = b"") -> bytes:
    """As a browser sends it."""
    lines = [f"{method} {path} HTTP/1.1", f"Host: 127.0.0.1:{PORT}", f"Origin: {_ORIGIN}"]
    lines += [f"Cookie: {cookie}"] if cookie else []
    lines += [f"Content-Length: {len(body)}"] if body else []
    return "\r\n".join([*lines, "", ""]).encode("utf-8", "surrogateescape") + body


def _taken_apart(raw: bytes) -> tuple[Scope, bytes, bool]:
    """Scope, body, and whether that was all of it. Raises h11.RemoteProtocolError."""
    connection = h11.Connection(h11.SERVER)
    connection.receive_data(raw)
    head = connection.next_event()
    if not isinstance(head, h11.Request):
        raise h11.RemoteProtocolError("no whole head")
    body, whole = b"", False
    while True:
        event = connection.next_event()
        if isinstance(event, h11.Data):
            body += bytes(event.data)
        else:
            whole = isinstance(event, h11.EndOfMessage)
            break
    raw_path, _, query = head.target.partition(b"?")
    scope = {
        "type": "http", "asgi": {"version": "3.0", "spec_version": "2.3"},
        "http_version": head.http_version.decode("ascii"), "method": head.method.decode("ascii"),
        "scheme": "http", "path": unquote(raw_path.decode("ascii")), "raw_path": raw_path,
        "query_string": query, "root_path": "", "headers": list(head.headers),
        "client": ("127.0.0.1", 50_000), "server": ("127.0.0.1", PORT), "state": {},
    }  # fmt: skip
    return scope, body, whole


def _socket_scope(path: str, cookie: str, origin: str) -> Scope:
    headers = [("host", f"127.0.0.1:{PORT}"), ("origin", origin), ("cookie", cookie)]
    bare, _, query = path.partition("?")
    return {
        "type": "websocket", "asgi": {"version": "3.0", "spec_version": "2.3"}, "http_version": "1.1",
        "scheme": "ws", "path": bare, "raw_path": bare.encode(), "query_string": query.encode(),
        "root_path": "", "subprotocols": [], "state": {}, "extensions": {"websocket.http.response": {}},
        "headers": [
            (name.encode(), value.encode("latin-1", "replace")) for name, value in headers if value
        ],
        "client": ("127.0.0.1", 50_000), "server": ("127.0.0.1", PORT),
    }  # fmt: skip


def _as_frame(message: bytes) -> Message:
    """Text where it can be: a text that is no UTF-8 does not get through the protocol."""
    try:
        return {"type": "websocket.receive", "text": message.decode()}
    except UnicodeDecodeError:
        return {"type": "websocket.receive", "bytes": message}
