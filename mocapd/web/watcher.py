"""A client of the live view without a browser, to measure the cost of watching."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from mocapd.errors import UnavailableError
from mocapd.web.links.picture_link import DEFAULT_WIDTH_PX
from mocapd.web.runtime_file import Running, running

ANNOUNCED_S = 20.0  # timeout of the daemon's page announcement [s]


class Watcher:
    """`pictures` and `messages` count the received JPEGs of all cameras and live data."""

    def __init__(self) -> None:
        self.pictures = 0
        self.messages = 0

    def pull_pictures(self, socket: ClientConnection, cameras: tuple[str, ...]) -> None:
        """Request every camera's next picture on arrival of the last, until it closes."""
        with suppress(ConnectionClosed):
            for camera in cameras:
                socket.send(_request(camera, None))
            for data in socket:
                assert isinstance(data, bytes)
                header = json.loads(data[4 : 4 + int.from_bytes(data[:4], "little")])
                self.pictures += header["seq"] is not None
                socket.send(_request(header["camera"], header["seq"]))

    def take_messages(self, socket: ClientConnection) -> None:
        """Read live data until it closes."""
        with suppress(ConnectionClosed):
            for _ in socket:
                self.messages += 1


@contextmanager
def watching(runtime_dir: Path) -> Iterator[Watcher]:
    """Watch all views of the page announced under `runtime_dir`, in threads.

    `runtime_dir` is the daemon's $XDG_RUNTIME_DIR. Raises UnavailableError when there is no page.
    """
    page = _page(runtime_dir / "mocapd")
    watcher = Watcher()
    with ExitStack() as opened:
        live = opened.enter_context(connect(socket_address(page.url, "/live"), proxy=None))
        pictures = opened.enter_context(connect(socket_address(page.url, "/pictures"), proxy=None))
        threads = (
            threading.Thread(target=watcher.take_messages, args=(live,)),
            threading.Thread(target=watcher.pull_pictures, args=(pictures, page.status.cameras)),
        )
        for thread in threads:
            thread.start()
        try:
            yield watcher
        finally:
            opened.close()
            for thread in threads:
                thread.join()


def _page(folder: Path) -> Running:
    give_up_s = time.monotonic() + ANNOUNCED_S
    while time.monotonic() < give_up_s:
        for page in running(folder):
            return page
        time.sleep(0.1)
    raise UnavailableError("the daemon serves no page", str(folder), "set web.enabled = true")


def socket_address(url: str, path: str) -> str:
    """The address of a WebSocket of the page at this URL, with its token."""
    return urlsplit(url)._replace(scheme="ws", path=path).geturl()


def _request(camera: str, after: int | None) -> str:
    return json.dumps({"camera": camera, "width": DEFAULT_WIDTH_PX, "after": after})
