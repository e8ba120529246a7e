"""Changed requests and messages to the page, with its token: none may end the daemon."""

import json
import random
import socket
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, suppress
from itertools import islice

from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from mocapd.web.games.frames_access import PATH as FRAMES_PATH
from tests.attacks.attacked_page import PATIENCE_S, SITE, AttackedPage, attacked_page
from tests.attacks.scenario import Found, Scenario

SEED = 20261122
BATCH = 25  # inputs between two looks at the daemon
LOOK_S = 0.3  # for a thread of its to die of them [s]
MOST_DEATHS = 8  # then the rest is not tried

_PATHS = ("/", "/status", "/page/app.js", "/page/", "/picture/strokes/1", "/setup", "/ws", "/live")
_STEPS = ("cameras", "lens", "room", "colour", "body", "check")
_COMMANDS = (
    *({"verb": "go", "args": {"step": step}} for step in _STEPS),
    {"verb": "next"},
    {"verb": "again"},
    {"verb": "begin"},
    {"verb": "take_over"},
    {"verb": "leave_out", "args": {"camera": "cam0"}},
    {"verb": "take_in", "args": {"camera": "cam0"}},
    {"verb": "name", "args": {"camera": "cam0", "name": "left"}},
    {"verb": "mode", "args": {"camera": "cam0", "size_px": [640, 480], "fps_hz": 30}},
    {"verb": "lock", "args": {"camera": "cam0"}},
    {"verb": "same_port", "args": {"camera": "cam0", "same": True}},
    {"verb": "board", "args": {
        "kind": "chessboard", "columns": 5, "rows": 4, "square_mm": 30, "marker_mm": 20,
        "dictionary": "DICT_4X4_1000", "inverted": False, "legacy": False, "two_sided": False,
    }},
    {"verb": "ruler", "args": {"mm": 100}},
    {"verb": "use_saved", "args": {"camera": "cam0"}},
    {"verb": "measure", "args": {"camera": "cam0"}},
    {"verb": "finish"},
    {"verb": "method", "args": {"method": "wearer"}},
    {"verb": "walk"},
    {"verb": "stop"},
    {"verb": "solve"},
    {"verb": "floor"},
    {"verb": "skip_floor"},
    {"verb": "freeze", "args": {"seconds": 1}},
    {"verb": "propose"},
    {"verb": "strokes", "args": {"camera": "cam0", "png_base64": "iVBORw0KGgo=", "by": "me"}},
    {"verb": "personal", "args": {"on": True}},
    {"verb": "stature", "args": {"m": 1.75}},
    {"verb": "skip"},
    {"verb": "save"},
)  # fmt: skip
_REQUESTS = (
    {"camera": "cam0", "width": 480, "after": None, "over": "setup"},
    {"camera": "cam1", "width": 64, "after": 3, "over": "body"},
)
_SEEN = ({"seen": 0}, {"seen": 7})
_NASTY = (
    "null", "true", "-1", "0", "1e400", "1e308", "-1e-320", "1" + 30 * "0", "9" * 5000, "NaN",
    "20000", "2", "3", "0.5", '""', '"\u00e9"', '"\\u0000"', '"\\ud800"', '"' + 6000 * "x" + '"',
    '"../../etc/passwd"', '"%s%n{0}"', "[]", "{}", "[[]]", '{"a": []}', "[" * 2000 + "]" * 2000,
    "[" * 40 + "]" * 40, '"iVBORw0KGgoAAAANSUhEUgABAAAAAQAACAAAAAAA"', "[1e999, null]",
)  # fmt: skip


def changed_bytes(data: bytes, chance: random.Random) -> bytes:
    """Some bytes replaced, left out, doubled, or the end cut off."""
    out = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(out) + 1)
        kind = chance.randrange(4)
        if kind == 0:
            out[at : at + 1] = bytes([chance.randrange(256)])
        elif kind == 1:
            del out[at : at + chance.randint(1, 8)]
        elif kind == 2:
            out[at:at] = out[at : at + chance.randint(1, 40)]
        elif chance.random() < 0.3:
            del out[at:]
    return bytes(out)


def changed_json(message: object, chance: random.Random) -> bytes:
    """One of its values, at any depth, is another."""
    text = json.dumps(message)
    values = list(_values(message))
    old = json.dumps(chance.choice(values)) if values else text
    at = chance.randrange(text.count(old)) if text.count(old) else 0
    parts = text.split(old)
    new = chance.choice(_NASTY)
    return (old.join(parts[: at + 1]) + new + old.join(parts[at + 1 :])).encode()


def _values(tree: object) -> Iterator[object]:
    if isinstance(tree, dict):
        for one in tree.values():
            yield one
            yield from _values(one)
    elif isinstance(tree, list):
        yield from tree


def messages(whole: Iterable[object], chance: random.Random) -> Iterator[bytes]:
    """Whole ones now and then, so that there is a state to be in; else changed ones."""
    known = tuple(whole)
    while True:
        message, kind = chance.choice(known), chance.random()
        if kind < 0.15:
            yield json.dumps(message).encode()
        elif kind < 0.75:
            yield changed_json(message, chance)
        else:
            yield changed_bytes(json.dumps(message).encode(), chance)


class Sockets:
    """Sends to one path's WebSocket, opened anew whenever it was closed."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._open: ClientConnection | None = None

    def send(self, page: AttackedPage, data: bytes, chance: random.Random) -> None:
        """As text where it is text, for the most part."""
        try:
            if self._open is None:
                self._open = self._opened(page)
                if self._path == "/ws":
                    self._open.send('{"verb": "take_over"}')
                    self._open.send('{"verb": "begin"}')
            text = chance.random() < 0.7
            self._open.send(data.decode(errors="replace") if text else data)
            with suppress(TimeoutError):
                while True:
                    self._open.recv(0)
        except (WebSocketException, OSError):
            self.close()

    def _opened(self, page: AttackedPage) -> ClientConnection:
        is_game = self._path == FRAMES_PATH
        secret = f"key={page.frames_key}" if is_game else f"token={page.token}"
        return connect(
            f"ws://{page.host}{self._path}?{secret}",
            origin=Origin(SITE) if is_game else None,
            proxy=None,
            open_timeout=PATIENCE_S,
            max_size=None,
        )

    def close(self) -> None:
        """Until the next message."""
        with suppress(WebSocketException, OSError), ExitStack() as closing:
            if self._open is not None:
                closing.callback(self._open.close)
        self._open = None


class Requests:
    """Sends each as a connection of its own."""

    def send(self, page: AttackedPage, data: bytes, chance: random.Random) -> None:
        """The token and the host are put in only now, as they differ between starts."""
        del chance
        data = data.replace(b"@TOKEN", page.token.encode()).replace(b"@HOST", page.host.encode())
        with suppress(OSError), socket.create_connection(("127.0.0.1", page.port)) as one:
            one.settimeout(0.5)  # an incomplete one is not answered
            one.sendall(data)
            one.shutdown(socket.SHUT_WR)
            while one.recv(65536):
                pass

    def close(self) -> None:
        """Nothing is open."""


def requests(chance: random.Random) -> Iterator[bytes]:
    """Changed HTTP requests."""
    nasty = ("%ff", "%00", "..%2f", "\u00e9", "x" * 400, "//", "%", "?", "#", ";", "\\", "a" * 9000)
    while True:
        path = chance.choice(_PATHS)
        if chance.random() < 0.5:
            path += chance.choice(nasty) + chance.choice(("", ".js", "/"))
        head = f"{chance.choice(('GET', 'GET', 'HEAD', 'POST', 'OPTIONS'))} {path}?token=@TOKEN "
        lines = [head + "HTTP/1.1", "Host: @HOST", "Connection: close"]
        if chance.random() < 0.3:
            lines += [chance.choice((
                "Cookie: mocapd-1=\u00ff; =; ;;", "Range: bytes=0-,0-,-1", "Origin: http://@HOST",
                "Content-Length: 5", "Transfer-Encoding: chunked", "Upgrade: websocket",
                "Expect: 100-continue", "Accept-Encoding: \u00e9",
            ))]  # fmt: skip
        data = ("\r\n".join(lines) + "\r\n\r\n").encode()
        yield changed_bytes(data, chance) if chance.random() < 0.5 else data


def bodies(chance: random.Random) -> Iterator[bytes]:
    """Changed bodies of POST /setup."""
    for body in messages(({"step": step} for step in _STEPS), chance):
        head = "POST /setup?token=@TOKEN HTTP/1.1\r\nHost: @HOST\r\nConnection: close\r\n"
        yield f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body


def deaths(
    count: int, inputs: Callable[[random.Random], Iterator[bytes]], via: Sockets | Requests
) -> Found:
    """Send so many; a daemon that has died is started anew."""
    chance = random.Random(SEED)
    rest = islice(inputs(chance), count)
    died: Counter[str] = Counter()
    slowest_s, sent = 0.0, 0
    while sent < count and died.total() < MOST_DEATHS:
        with attacked_page() as page:
            while batch := list(islice(rest, BATCH)):
                began_s = time.monotonic()
                for data in batch:
                    via.send(page, data, chance)
                sent += len(batch)
                time.sleep(LOOK_S)
                if page.answers(PATIENCE_S) is None:
                    died[page.last_error() or "no answer any more"] += 1
                    via.close()
                    break
                slowest_s = max(slowest_s, time.monotonic() - began_s)
            via.close()
    kinds = "".join(f"; {n}x {why}" for why, n in died.items())
    figure = f"{died.total()} of {sent}, slowest {BATCH} took {slowest_s:.1f} s{kinds}"
    return Found(figure, not died and sent == count)


SCENARIOS = {
    "page-requests": Scenario("0 deaths of 2000", lambda: deaths(2000, requests, Requests())),
    "page-setup": Scenario("0 deaths of 500", lambda: deaths(500, bodies, Requests())),
    "page-ws": Scenario(
        "0 deaths of 1500",
        lambda: deaths(1500, lambda chance: messages(_COMMANDS, chance), Sockets("/ws")),
    ),
    "page-pictures": Scenario(
        "0 deaths of 500",
        lambda: deaths(500, lambda chance: messages(_REQUESTS, chance), Sockets("/pictures")),
    ),
    "page-live": Scenario(
        "0 deaths of 500",
        lambda: deaths(500, lambda chance: messages(({"watch": True},), chance), Sockets("/live")),
    ),
    "page-frames": Scenario(
        "0 deaths of 500",
        lambda: deaths(500, lambda chance: messages(_SEEN, chance), Sockets(FRAMES_PATH)),
    ),
}
