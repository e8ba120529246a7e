"""Reads the JSON of a request, and answers in JSON."""

from collections.abc import Callable
from typing import TypeVar

from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from mocapd.boundary.parsing import decode_json
from mocapd.errors import MalformedError, MocapdError
from mocapd.web.shown_json import as_json
from mocapd.web.status_page import SetupAnswer

LONGEST_BODY = 64 << 10  # of any valid request [bytes]

T = TypeVar("T")


async def read_request(request: Request, kind: type[T], empty: bytes = b"") -> T:
    """The request's body; `empty`: in place of an empty one. Raises HTTPException for one that is too long, or not
    understood, and ClientDisconnect."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LONGEST_BODY:
            # the rest is not waited for
            raise HTTPException(413, "that is too much", {"connection": "close"})
    try:
        return decode_json(bytes(body) or empty, kind)
    except MalformedError as error:
        raise HTTPException(400, f"not understood: {error}") from None


async def answer(work: Callable[[], Response]) -> Response:
    """The answer of work that may wait for a disk or a process; 503 with its error."""
    try:
        return await run_in_threadpool(work)
    except MocapdError as error:
        return json_answer(SetupAnswer(error.what, error.where, error.fix), 503)


def json_answer(message: object, status: int = 200) -> Response:
    """See `as_json`."""
    return Response(as_json(message), status, media_type="application/json")
