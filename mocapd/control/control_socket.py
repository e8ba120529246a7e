"""Server of the control socket: answers its own user and root, each connection in a thread, a few at once."""

import logging
import os
import socket
import socketserver
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec

from mocapd.boundary.parsing import decode_json
from mocapd.control.control_messages import Answer, Refused, Request, Verb
from mocapd.control.line import read_line
from mocapd.control.socket_place import may_command, peer_of, short_address
from mocapd.errors import MalformedError, MocapdError, PermissionDeniedError, creation_errors

LONGEST_REQUEST = 4 << 10  # [bytes]
ASK_S = 2.0  # timeout of receiving a request and of sending the answer [s]
MOST_AT_ONCE = 16  # connections; further ones are closed
_LOOK_EVERY_S = 0.1  # poll interval of the shutdown flag [s]

_log = logging.getLogger(__name__)


class ControlSocket:
    """Serves from `open` to `close`. `answer` executes a request, in a thread of its own, and raises MocapdError to refuse;
    `died` is called there with any unexpected exception."""

    def __init__(
        self,
        path: Path,
        answer: Callable[[Verb], msgspec.Struct],
        died: Callable[[BaseException], None],
    ) -> None:
        self._path, self._answer, self._died = path, answer, died
        self._server: _Server | None = None

    def open(self) -> None:
        """Starts serving. Raises CannotCreateError."""
        folder, mend = self._path.parent, "set XDG_RUNTIME_DIR to your own folder"
        with creation_errors(folder, mend, "no control socket can be made"):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            # renamed once it listens: whoever looks for daemons removes sockets at which nobody does
            hidden = self._path.with_name(f".{self._path.name}")
            hidden.unlink(missing_ok=True)  # left by an earlier process with our pid
            self._server = _Server(hidden, self._answer, self._died)
            hidden.rename(self._path)
        threading.Thread(
            target=self._server.serve_forever, args=(_LOOK_EVERY_S,), name="control", daemon=True
        ).start()

    def close(self) -> None:
        """Refuses new connections; open ones end with the process. Idempotent."""
        server, self._server = self._server, None
        if server is not None:
            server.shutdown()
            server.server_close()
            with suppress(OSError):
                self._path.unlink()


class _Server(socketserver.ThreadingMixIn, socketserver.UnixStreamServer):
    daemon_threads = True
    request_queue_size = MOST_AT_ONCE

    def __init__(
        self,
        path: Path,
        answer: Callable[[Verb], msgspec.Struct],
        died: Callable[[BaseException], None],
    ) -> None:
        self.answer = answer
        self._died = died
        self._room = threading.BoundedSemaphore(MOST_AT_ONCE)
        self._has_logged_stranger = False
        with short_address(path) as address:
            super().__init__(address, _Connection)

    def server_bind(self) -> None:
        """Private from its creation: Linux creates the file with the socket's mode."""
        os.fchmod(self.socket.fileno(), 0o600)
        self.socket.bind(self.server_address)

    def verify_request(self, _request: Any, _address: Any) -> bool:
        """True if another connection is allowed."""
        return self._room.acquire(blocking=False)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Handles one connection, in its thread."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()

    def handle_error(self, _request: Any, _address: Any) -> None:
        """Reports an exception, which the library would only print."""
        error = sys.exc_info()[1]
        if error is not None:
            self._died(error)

    def stranger(self, uid: int) -> None:
        """Logs the first connection of another user, which the file's mode should prevent."""
        if not self._has_logged_stranger:
            self._has_logged_stranger = True
            _log.warning("user %d asked at the control socket, and is refused", uid)


class _Connection(socketserver.BaseRequestHandler):
    server: _Server
    request: socket.socket

    def handle(self) -> None:
        """Reads one line, answers with one."""
        with suppress(OSError):  # it has left, or takes too long
            self.request.settimeout(ASK_S)
            self.request.sendall(msgspec.json.encode(self._make_answer()) + b"\n")

    def _make_answer(self) -> Answer:
        try:
            uid = peer_of(self.request)
            if not may_command(uid):
                self.server.stranger(uid)
                raise PermissionDeniedError("another user's", "the control socket")
            asked = decode_json(read_line(self.request, LONGEST_REQUEST, ASK_S), Request)
            result = self.server.answer(asked.verb)
            return Answer(msgspec.Raw(msgspec.json.encode(result)))
        except MalformedError as error:
            return _refusal(MalformedError(f"not understood: {error.what}", "the control socket"))
        except MocapdError as error:
            return _refusal(error)


def _refusal(error: MocapdError) -> Answer:
    return Answer(refused=Refused(error.what, error.where, error.fix, error.exit_code))
