"""The files of clients/web as a static server gives them, and a daemon that says whatever a test wants."""

import queue
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

PAGE = Path(__file__).resolve().parents[2] / "clients" / "web"


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Nobody reads it."""


@contextmanager
def game_site() -> Iterator[str]:
    """Its origin."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(PAGE))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()


class AnyDaemon:
    """`say` sends a text or bytes to the page that is connected; `hang_up` ends the connection."""

    def __init__(self) -> None:
        self._words: queue.Queue[str | bytes | None] = queue.Queue()
        self.address = ""

    def say(self, *words: str | bytes) -> None:
        for word in words:
            self._words.put(word)

    def hang_up(self) -> None:
        self._words.put(None)

    def answer(self, link: ServerConnection) -> None:
        """One connection, until it is hung up."""
        try:
            while (word := self._words.get()) is not None:
                link.send(word)
        except ConnectionClosed:
            return


@contextmanager
def any_daemon() -> Iterator[AnyDaemon]:
    daemon = AnyDaemon()
    with serve(daemon.answer, "127.0.0.1", 0) as server:
        daemon.address = f"ws://127.0.0.1:{server.socket.getsockname()[1]}/frames?key=any"
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield daemon
        finally:
            daemon.hang_up()
            server.shutdown()
