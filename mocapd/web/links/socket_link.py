"""Common functions of the page's WebSockets."""

import asyncio
from collections.abc import Awaitable, Coroutine, Iterable, Iterator
from contextlib import suppress
from typing import TypeVar

from starlette.websockets import WebSocket, WebSocketDisconnect

from mocapd.boundary.parsing import decode_json
from mocapd.errors import MalformedError
from mocapd.web.shown_json import as_json

T = TypeVar("T")

LONGEST_MESSAGE = 8 << 20  # strokes come as PNG in base64 [bytes]
_WS_BAD_DATA = 1007
_WS_GONE = 1006
_LONGEST_REASON = 120  # of a closed WebSocket; its frame holds 123 [bytes]
MOST_HZ = 15.0  # highest rate of messages to a page


class BadMessageError(Exception):
    """An invalid message, perhaps of a page of another version."""


async def receive(socket: WebSocket) -> str | bytes:
    """The next message, text or binary. Raises WebSocketDisconnect."""
    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message.get("code", 1005))
    text: str | None = message.get("text")
    data: bytes = message.get("bytes") or b""
    return text if text is not None else data


async def understood(socket: WebSocket, kind: type[T], longest: int = LONGEST_MESSAGE) -> T:
    """The next message as `kind`, of at most `longest` bytes. Raises WebSocketDisconnect or BadMessageError."""
    said = await receive(socket)
    if len(said) > longest:
        raise BadMessageError("that is too much")
    try:
        return decode_json(said, kind)
    except MalformedError as error:
        raise BadMessageError(str(error)) from error


async def send_json(socket: WebSocket, message: object) -> None:
    """Send a message as text; see `as_json`. Raises WebSocketDisconnect."""
    await _sent(socket.send_text(as_json(message).decode()))


async def send_bytes(socket: WebSocket, message: bytes) -> None:
    """Send a binary message. Raises WebSocketDisconnect."""
    await _sent(socket.send_bytes(message))


async def _sent(sending: Awaitable[None]) -> None:
    """Another task of ours, or uvicorn after an oversized message, may have closed the socket already. Both libraries
    then raise RuntimeError, which means here that the page has left."""
    try:
        await sending
    except RuntimeError as closed:
        raise WebSocketDisconnect(_WS_GONE) from closed


async def serve(socket: WebSocket, *jobs: Coroutine[object, object, None]) -> None:
    """Accept, and run these jobs until the first ends, mostly because the browser has left."""
    await socket.accept()
    tasks = [asyncio.ensure_future(job) for job in jobs]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        ended = await asyncio.gather(*tasks, return_exceptions=True)
    for error in _leaves(ended):
        if isinstance(error, BadMessageError):
            # only now: no other job sends any more
            with suppress(WebSocketDisconnect):
                reason = str(error).encode()[:_LONGEST_REASON].decode(errors="ignore")
                await _sent(socket.close(_WS_BAD_DATA, reason))
        elif not isinstance(error, WebSocketDisconnect | asyncio.CancelledError):
            raise error


def _leaves(ended: Iterable[BaseException | None]) -> Iterator[BaseException]:
    for one in ended:
        if isinstance(one, BaseExceptionGroup):
            yield from _leaves(one.exceptions)
        elif one is not None:
            yield one
