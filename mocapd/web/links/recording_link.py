"""The WebSocket `/recording`: every picture of every camera, for `mocapd record --pictures`.

Messages as those of `/pictures`: length of the header, the header as JSON, bytes. First the files with the set-up of
cameras and wearer, {file, media_type}; then each picture, {camera, seq, unix_ns, dropped} and the camera's own JPEG, or
else a new one. dropped: pictures that the recorder was too slow for, since the beginning.
"""

import asyncio
import threading
from collections import deque
from concurrent.futures import Executor

from starlette.websockets import WebSocket

from mocapd.capture.recording.recording_metadata import attachments_of
from mocapd.clock import unix_from_monotonic_ns
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Frame
from mocapd.web.encoder import Picture, camera_jpeg, encode
from mocapd.web.host import Host
from mocapd.web.links.picture_link import message
from mocapd.web.links.socket_link import BadMessageError, receive, send_bytes, serve

MOST_WAITING = 24  # pictures of all cameras: a third of a second of two
RECORDED_QUALITY = 95  # of a picture that no camera has encoded
_LOOK_EVERY_S = 0.008


class _Taken:
    """Queue of pictures for the link's event loop. `put` in the capture threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._waiting: deque[Picture | Frame] = deque()
        self.dropped = 0

    def put(self, frame: Frame) -> None:
        # a JPEG takes a tenth of the memory of its pixels
        picture = camera_jpeg(frame, _width(frame)) or frame
        with self._lock:
            if len(self._waiting) >= MOST_WAITING:
                self._waiting.popleft()
                self.dropped += 1
            self._waiting.append(picture)

    def next(self) -> Picture | Frame | None:
        """The oldest one; a Frame where its camera delivered no usable JPEG."""
        with self._lock:
            return self._waiting.popleft() if self._waiting else None


class RecordingLink:
    """One recorder; frames without a JPEG are encoded in `executor`."""

    def __init__(self, socket: WebSocket, host: Host, executor: Executor) -> None:
        self._socket, self._host, self._executor = socket, host, executor

    async def run(self) -> None:
        """Until the recorder leaves."""
        await serve(self._socket, self._send(), self._read_messages())

    async def _read_messages(self) -> None:
        await receive(self._socket)
        raise BadMessageError("nothing is to be said here")

    async def _send(self) -> None:
        loop = asyncio.get_running_loop()
        files = await loop.run_in_executor(self._executor, attachments_of, self._host.known())
        for file in files:
            header = {"file": file.name, "media_type": file.media_type}
            await send_bytes(self._socket, message(header, file.data))
        taken, hub = _Taken(), None
        try:
            while True:
                # another session has cameras of its own
                hub = _switch_hub(taken, hub, self._host.hub)
                picture = taken.next()
                if picture is None:
                    await asyncio.sleep(_LOOK_EVERY_S)
                    continue
                if isinstance(picture, Frame):
                    picture = await loop.run_in_executor(
                        self._executor, encode, picture, _width(picture), RECORDED_QUALITY
                    )
                await send_bytes(self._socket, _message(picture, taken.dropped))
        finally:
            _switch_hub(taken, hub, None)


def _width(frame: Frame) -> int:
    return frame.size_px[0]


def _message(picture: Picture, dropped: int) -> bytes:
    unix_ns = picture.t_ns + unix_from_monotonic_ns()
    header = {
        "camera": picture.camera,
        "seq": picture.seq,
        "unix_ns": unix_ns,
        "dropped": dropped,
    }
    return message(header, picture.jpeg)


def _switch_hub(taken: _Taken, old: FrameHub | None, new: FrameHub | None) -> FrameHub | None:
    """Subscribe the queue to the new hub instead of the old one; returns the new hub."""
    if new is not old:
        if old is not None:
            old.leave(taken)
        if new is not None:
            new.join(taken)
    return new
