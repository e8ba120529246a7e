"""Reads the body of a request up to a limit."""

from starlette.requests import Request

LONGEST_BODY = 64 << 10  # of any valid request [bytes]


class BodyTooLongError(Exception):
    """A body is longer than LONGEST_BODY."""


async def read_body(request: Request) -> bytes:
    """The body. Raises BodyTooLongError at the limit, and ClientDisconnect."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LONGEST_BODY:
            raise BodyTooLongError
    return bytes(body)
