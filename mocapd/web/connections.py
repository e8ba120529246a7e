"""Limits the number of connections to the page, and their timeouts.

Any process of the machine can connect without the token. So above the limit the oldest unauthorised connection is
closed: idle ones then cannot block the page or use up descriptors. uvicorn itself closes only connections that are idle
after an answer.
"""

import asyncio
from typing import Any, cast

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from mocapd.web.access import LET_IN

MOST = 64  # connections at once
ACCEPTED_AT_ONCE = 16  # their requests are read before MOST further connections arrive
QUEUE = 512  # the system's backlog of connections
LONGEST_HEAD = 16 << 10  # address and headers of a request [bytes]
# from its first byte, or from connecting, until a request is whole [s]: a browser on a busy machine pauses for seconds, and
# a script of the page that is cut off leaves it dead
REQUEST_S = 20.0
STALLED_S = 20.0  # timeout of a client that does not read [s]


class _Connection(asyncio.Protocol):
    """The common part of both protocols; the other names are uvicorn's."""

    loop: asyncio.AbstractEventLoop
    transport: asyncio.Transport
    connections: set[Any]  # all of the server
    scope: Any
    since_s = 0.0
    dropped = False
    _stalled: asyncio.TimerHandle | None = None

    def drop(self) -> None:
        """Close it now, and discard unsent data."""
        self.dropped = True
        self.transport.abort()

    @property
    def in_use(self) -> bool:
        """True for an authorised connection that is not closing."""
        scope = getattr(self, "scope", None)  # missing before a request
        return bool(scope and scope["state"].get(LET_IN)) and not self.transport.is_closing()

    def pause_writing(self) -> None:
        """The send buffer is full: the client does not read."""
        super().pause_writing()
        self._stalled = self.loop.call_later(STALLED_S, self.drop)

    def resume_writing(self) -> None:
        """The client reads again."""
        super().resume_writing()
        self._end_stall()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the timers of the closed connection."""
        self._end_stall()
        super().connection_lost(exc)

    def _end_stall(self) -> None:
        if self._stalled is not None:
            self._stalled.cancel()
            self._stalled = None


class HttpConnection(_Connection, H11Protocol):
    """With a timeout of REQUEST_S for a complete request, headers and body."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """A client has connected."""
        super().connection_made(transport)
        self.since_s = self.loop.time()
        self._expect()
        make_room(self.connections)

    def data_received(self, data: bytes) -> None:
        """A part of a request, or several of them."""
        self._expect()
        super().data_received(data)
        if self.conn.their_state not in (h11.IDLE, h11.SEND_BODY):
            self._end_wait()

    def on_response_complete(self) -> None:
        """An answer is sent; the next request may have begun to arrive before."""
        super().on_response_complete()
        if self.conn.their_state is h11.SEND_BODY:
            self._expect()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Pass the transport to the WebSocket protocol."""
        self._end_wait()
        if self.flow.write_paused:  # the other protocol would not learn of it
            self.drop()
        else:
            super().handle_websocket_upgrade(event)

    def send_400_response(self, msg: str) -> None:
        """The data is no HTTP: perhaps the body of a request whose answer is under way. uvicorn would send its error
        within that answer and break it."""
        cycle = cast(RequestResponseCycle | None, self.cycle)
        if cycle is not None and not cycle.response_complete:
            cycle.disconnected = True
            cycle.message_event.set()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            super().send_400_response(msg)
        else:
            self.transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the timers of the closed connection."""
        self._end_wait()
        super().connection_lost(exc)

    def _expect(self) -> None:
        if self._deadline is None:
            self._deadline = self.loop.call_later(REQUEST_S, self.drop)

    def _end_wait(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


class SocketConnection(_Connection, WebSocketsSansIOProtocol):
    """A WebSocket."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called after the upgrade of an HTTP request."""
        super().connection_made(transport)
        self.since_s = self.loop.time()

    def data_received(self, data: bytes) -> None:
        """The first data is the whole request, which may be valid for HTTP but not for a WebSocket."""
        super().data_received(data)
        if not self.handshake_initiated:  # and uvicorn would wait for ever
            self.transport.write(b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n")
            self.transport.close()

    def handle_ping(self) -> None:
        """Answer, unless the client does not read: answers would accumulate."""
        if self.writable.is_set():
            super().handle_ping()
        else:
            self.conn.data_to_send()  # discards the answer


def make_room(connections: set[_Connection]) -> None:
    """For a new connection: above the limit close the oldest unauthorised one, else the oldest."""
    open_ones = [connection for connection in connections if not connection.dropped]
    if len(open_ones) > MOST:
        min(open_ones, key=lambda connection: (connection.in_use, connection.since_s)).drop()
