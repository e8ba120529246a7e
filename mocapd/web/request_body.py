"""The body of a request, bounded."""

from starlette.requests import Request

LONGEST_BODY = 64 << 10  # of anything that we are asked for [bytes]


class BodyTooLongError(Exception):
    """A body is longer than anything we are asked for."""


async def read_body(request: Request) -> bytes:
    """Raises BodyTooLongError as soon as it is known, and ClientDisconnect."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > LONGEST_BODY:
            raise BodyTooLongError
    return bytes(body)
