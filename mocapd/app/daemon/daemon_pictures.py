"""Receives a running daemon's pictures from its page, for `mocapd record --pictures`."""

import queue
import threading
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Self

import msgspec
from msgspec import Meta
from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect

from mocapd.boundary.image_decoding import MOST_FILE_BYTES
from mocapd.boundary.mcap_records import McapAttachment
from mocapd.boundary.parsing import decode_json
from mocapd.errors import MalformedError, UnavailableError
from mocapd.outputs.mcap.recording_writer import RecordingWriter
from mocapd.web.runtime_file import Running, running
from mocapd.web.watcher import socket_address

MOST_WAITING = 256
_OPEN_S = 5.0
_JOIN_S = 1.0


class RecordingHeader(msgspec.Struct, frozen=True):
    """The header of a file or picture: see web.recording_link."""

    file: str = ""
    media_type: str = ""
    camera: str = ""
    seq: Annotated[int, Meta(ge=0)] = 0
    unix_ns: Annotated[int, Meta(ge=0, le=2**63 - 1)] = 0
    dropped: int = 0


class DaemonPictures:
    """Connected from `__enter__` to `__exit__`. `dropped`: pictures lost to full queues; `over`: reason of the stream's
    end."""

    def __init__(self, folder: Path, instance: str) -> None:
        """folder: of the page announcements (web.runtime_file); instance: the daemon's name."""
        self._folder, self._instance = folder, instance
        self._waiting: queue.Queue[tuple[RecordingHeader, bytes]] = queue.Queue(MOST_WAITING)
        self._opened = ExitStack()
        self._socket: ClientConnection | None = None
        self._thread = threading.Thread(target=self._run, name="pictures", daemon=True)
        self._dropped_here = self._dropped_there = 0
        self.over = ""

    def __enter__(self) -> Self:
        """Raises UnavailableError without a page of this daemon and user."""
        page = _page_of(running(self._folder), self._instance, self._folder)
        try:
            self._socket = self._opened.enter_context(
                connect(
                    socket_address(page.url, "/recording"),
                    proxy=None,
                    max_size=MOST_FILE_BYTES,
                    open_timeout=_OPEN_S,
                )
            )
        except (OSError, WebSocketException) as error:
            raise UnavailableError(
                f"its page gives no pictures ({error})", self._instance, "restart the daemon"
            ) from None
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()
        if self._thread.ident is not None:
            self._thread.join(_JOIN_S)

    @property
    def dropped(self) -> int:
        """Pictures dropped by client and daemon."""
        return self._dropped_here + self._dropped_there

    def drain(self, writer: RecordingWriter, unix_ns: int) -> None:
        """Writes the items received so far; never waits. unix_ns: now, for files."""
        # not those that come meanwhile: a slow disk would never catch up
        for _ in range(self._waiting.qsize()):
            header, data = self._waiting.get_nowait()
            if header.file:
                writer.attach_file(McapAttachment(header.file, header.media_type, data), unix_ns)
            else:
                writer.picture(header.camera, header.seq, header.unix_ns, data)

    def _run(self) -> None:
        assert self._socket is not None
        try:
            for data in self._socket:
                self._take(data if isinstance(data, bytes) else data.encode())
            self.over = "the daemon has ended"
        except (WebSocketException, OSError, MalformedError) as error:
            self.over = str(error) or "the daemon has ended"

    def _take(self, data: bytes) -> None:
        """Raises MalformedError."""
        end = 4 + int.from_bytes(data[:4], "little")
        header = decode_json(data[4:end], RecordingHeader)
        self._dropped_there = max(self._dropped_there, header.dropped)
        try:
            self._waiting.put_nowait((header, data[end:]))
        except queue.Full:
            self._dropped_here += 1


def _page_of(pages: Iterable[Running], instance: str, folder: Path) -> Running:
    for page in pages:
        if page.instance == instance:
            return page
    raise UnavailableError(
        f"there is no page of daemon {instance!r}, which pictures come from",
        str(folder),
        "run this as the daemon's user on its machine, with web.enabled = true",
    )
