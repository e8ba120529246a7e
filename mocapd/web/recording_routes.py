"""HTTP routes of the page's recordings.

GET recordings: RecordingList. POST recordings: a RecordingRequest, answered with the new list or a SetupAnswer with
the error (503). GET recordings/ID: the file; GET recordings/ID/FORMAT: exported. POST recenter: make the person's facing
direction forward.
"""

import os
from collections.abc import Iterator
from typing import BinaryIO, Literal

import msgspec
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from mocapd.errors import UnavailableError
from mocapd.service.recordings_folder import Name, Notes, Recordings
from mocapd.web.answers import answer, json_answer, read_request
from mocapd.web.host import Host

_PART_BYTES = 1 << 18  # of a download
_MEDIA_TYPES = {"bvh": "text/plain", "csv": "text/csv", "trc": "text/plain"}


class RecordingRequest(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Start or stop a recording, or set its name and notes."""

    verb: Literal["start", "stop", "note"]
    id: str = ""
    name: Name = ""
    notes: Notes = ""


class RecordingRoutes:
    def __init__(self, host: Host) -> None:
        self._host = host

    def routes(self) -> list[Route]:
        return [
            Route("/recordings", self._list),
            Route("/recordings", self._do, methods=["POST"]),
            Route("/recordings/{id}", self._file),
            Route("/recordings/{id}/{format}", self._export),
            Route("/recenter", self._recenter, methods=["POST"]),
        ]

    async def _list(self, _request: Request) -> Response:
        return await answer(lambda: json_answer(self._recordings.list()))

    async def _do(self, request: Request) -> Response:
        asked = await read_request(request, RecordingRequest)

        def do() -> Response:
            recordings = self._recordings
            match asked.verb:
                case "start":
                    recordings.start()
                case "stop":
                    recordings.stop()
                case "note":
                    recordings.note(asked.id, asked.name, asked.notes)
            return json_answer(recordings.list())

        return await answer(do)

    async def _file(self, request: Request) -> Response:
        id_ = request.path_params["id"]

        def read() -> Response:
            file = self._recordings.opened(id_)
            name = self._recordings.file_name(id_, "mcap")
            return _download(file, name, "application/octet-stream")

        return await answer(read)

    async def _export(self, request: Request) -> Response:
        id_, format_ = request.path_params["id"], request.path_params["format"]

        def export() -> Response:
            file = self._recordings.export(id_, format_)
            name = self._recordings.file_name(id_, format_)
            return _download(file, name, _MEDIA_TYPES.get(format_, "application/octet-stream"))

        return await answer(export)

    async def _recenter(self, _request: Request) -> Response:
        def recenter() -> Response:
            self._host.recenter()
            return json_answer({})

        return await answer(recenter)

    @property
    def _recordings(self) -> Recordings:
        """Raises UnavailableError."""
        found = self._host.recordings
        if found is None:
            raise UnavailableError("nothing is tracked here", "recordings", "start `mocapd run`")
        return found


def _download(file: BinaryIO, name: str, media_type: str) -> Response:
    """Sends the open file in parts, then closes it: that of a long recording is larger than the memory of the service."""
    size_bytes = os.fstat(file.fileno()).st_size
    headers = {
        "content-disposition": f'attachment; filename="{name}"',
        "content-length": str(size_bytes),
    }
    return StreamingResponse(_parts(file, size_bytes), media_type=media_type, headers=headers)


def _parts(file: BinaryIO, size_bytes: int) -> Iterator[bytes]:
    """The first `size_bytes` of the file: one that is still being recorded grows meanwhile."""
    with file:
        while size_bytes > 0 and (part := file.read(min(size_bytes, _PART_BYTES))):
            size_bytes -= len(part)
            yield part
