"""HTTP routes of the page's recordings.

GET recordings: RecordingList. POST recordings: a RecordingRequest, answered with the new list or an Answer with the
error (503). GET recordings/ID: the file; GET recordings/ID/FORMAT: exported. POST recenter: make the person's facing
direction forward.
"""

from collections.abc import Callable
from typing import Literal

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from mocapd.boundary.parsing import decode_json
from mocapd.errors import MalformedError, MocapdError, UnavailableError
from mocapd.service.recordings_folder import Name, Notes, Recordings
from mocapd.web.host import Host
from mocapd.web.request_body import BodyTooLongError, read_body
from mocapd.web.shown_json import as_json

_MEDIA_TYPES = {"bvh": "text/plain", "csv": "text/csv", "trc": "text/plain"}


class RecordingRequest(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Start or stop a recording, or set its name and notes."""

    verb: Literal["start", "stop", "note"]
    id: str = ""
    name: Name = ""
    notes: Notes = ""


class RefusedRecording(msgspec.Struct, frozen=True):
    """The error of a refused request."""

    what: str
    where: str
    fix: str


class RecordingRoutes:
    """Of one host."""

    def __init__(self, host: Host) -> None:
        self._host = host

    def routes(self) -> list[Route]:
        """All of them."""
        return [
            Route("/recordings", self._list),
            Route("/recordings", self._do, methods=["POST"]),
            Route("/recordings/{id}", self._file),
            Route("/recordings/{id}/{format}", self._export),
            Route("/recenter", self._recenter, methods=["POST"]),
        ]

    async def _list(self, _request: Request) -> Response:
        return await _answer(lambda: _json(self._recordings.list()))

    async def _do(self, request: Request) -> Response:
        try:
            asked = decode_json(await read_body(request), RecordingRequest)
        except BodyTooLongError:
            return PlainTextResponse("that is too much", 413, headers={"connection": "close"})
        except MalformedError as error:
            return PlainTextResponse(f"not understood: {error}", 400)

        def do() -> Response:
            recordings = self._recordings
            match asked.verb:
                case "start":
                    recordings.start()
                case "stop":
                    recordings.stop()
                case "note":
                    recordings.note(asked.id, asked.name, asked.notes)
            return _json(recordings.list())

        return await _answer(do)

    async def _file(self, request: Request) -> Response:
        id_ = request.path_params["id"]

        def read() -> Response:
            data = self._recordings.file(id_).read_bytes()
            name = self._recordings.file_name(id_, "mcap")
            return _download(data, name, "application/octet-stream")

        return await _answer(read)

    async def _export(self, request: Request) -> Response:
        id_, format_ = request.path_params["id"], request.path_params["format"]

        def export() -> Response:
            data = self._recordings.export(id_, format_)
            name = self._recordings.file_name(id_, format_)
            return _download(data, name, _MEDIA_TYPES.get(format_, "application/octet-stream"))

        return await _answer(export)

    async def _recenter(self, _request: Request) -> Response:
        def recenter() -> Response:
            self._host.recenter()
            return _json({})

        return await _answer(recenter)

    @property
    def _recordings(self) -> Recordings:
        """Raises UnavailableError."""
        found = self._host.recordings
        if found is None:
            raise UnavailableError("nothing is tracked here", "recordings", "start `mocapd run`")
        return found


async def _answer(work: Callable[[], Response]) -> Response:
    """Of what may wait for a disk or a process."""
    try:
        return await run_in_threadpool(work)
    except MocapdError as error:
        return _json(RefusedRecording(error.what, error.where, error.fix), 503)


def _download(data: bytes, name: str, media_type: str) -> Response:
    headers = {"content-disposition": f'attachment; filename="{name}"'}
    return Response(data, media_type=media_type, headers=headers)


def _json(answer: object, status: int = 200) -> Response:
    return Response(as_json(answer), status, media_type="application/json")
