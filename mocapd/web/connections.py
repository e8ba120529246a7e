"""How many connections the page has at once, and how long one may keep it waiting.

Any process of the machine can connect, without the token. Whoever is not let in yet makes room for
those who come later, the oldest first, so that silent ones keep nobody out and the daemon keeps its
descriptors. uvicorn itself closes only a connection that is silent after an answer.
"""

import asyncio
from typing import Any, cast

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from mocapd.web.access import LET_IN

MOST = 64  # connections at once
ACCEPTED_AT_ONCE = 16  # their requests are heard before as many as MOST have come after them
QUEUE = 512  # of connections that the system keeps for us meanwhile
LONGEST_HEAD = 16 << 10  # address and headers of a request [bytes]
REQUEST_S = 5.0  # from its first byte, or from connecting, until a request is whole [s]
STALLED_S = 20.0  # how long somebody may not read what was sent [s]


class _Connection(asyncio.Protocol):
    """What both protocols have in common; the rest of their names is uvicorn's."""

    loop: asyncio.AbstractEventLoop
    transport: asyncio.Transport
    connections: set[Any]  # all of the server
    scope: Any
    since_s = 0.0
    dropped = False
    _stalled: asyncio.TimerHandle | None = None

    def drop(self) -> None:
        """Close it now, whatever is still to be sent."""
        self.dropped = True
        self.transport.abort()

    @property
    def in_use(self) -> bool:
        """Whether it belongs to somebody who was let in."""
        scope = getattr(self, "scope", None)  # there is none before a request
        return bool(scope and scope["state"].get(LET_IN)) and not self.transport.is_closing()

    def pause_writing(self) -> None:
        """More is to be sent than the system takes: nobody reads."""
        super().pause_writing()
        self._stalled = self.loop.call_later(STALLED_S, self.drop)

    def resume_writing(self) -> None:
        """It goes on."""
        super().resume_writing()
        self._end_stall()

    def connection_lost(self, exc: Exception | None) -> None:
        """It is closed."""
        self._end_stall()
        super().connection_lost(exc)

    def _end_stall(self) -> None:
        if self._stalled is not None:
            self._stalled.cancel()
            self._stalled = None


class HttpConnection(_Connection, H11Protocol):
    """Waits REQUEST_S for a request to be whole, headers and body."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Somebody has connected."""
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
        """From here on another protocol has the transport."""
        self._end_wait()
        if self.flow.write_paused:  # of which the other would not be told
            self.drop()
        else:
            super().handle_websocket_upgrade(event)

    def send_400_response(self, msg: str) -> None:
        """What has come is no HTTP: perhaps the body of a request that is being answered. uvicorn would
        say so in between, and that answer would then be an error of ours."""
        cycle = cast(RequestResponseCycle | None, self.cycle)
        if cycle is not None and not cycle.response_complete:
            cycle.disconnected = True
            cycle.message_event.set()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            super().send_400_response(msg)
        else:
            self.transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """It is closed."""
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
        """It was a request until now."""
        super().connection_made(transport)
        self.since_s = self.loop.time()

    def data_received(self, data: bytes) -> None:
        """The first time, the whole request: HTTP permits some that WebSockets do not."""
        super().data_received(data)
        if not self.handshake_initiated:  # and uvicorn would wait for ever
            self.transport.write(b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n")
            self.transport.close()

    def handle_ping(self) -> None:
        """Answered unless nobody reads, or the answers would pile up."""
        if self.writable.is_set():
            super().handle_ping()
        else:
            self.conn.data_to_send()  # forgets the answer


def make_room(connections: set[_Connection]) -> None:
    """One has come: when there are too many, close the oldest that nobody uses, else the newest."""
    there = [one for one in connections if not one.dropped]
    if len(there) > MOST:
        min(there, key=lambda one: (one.in_use, one.since_s)).drop()
