"""A VRChat as the network sees it: an HTTP service with HOST_INFO, announced by multicast DNS on 127.0.0.1 alone."""

import json
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING

from mocapd.outputs.vrchat.vrchat_finder import SERVICE

if TYPE_CHECKING:
    from zeroconf import Zeroconf

LOOPBACK = "127.0.0.1"


def host_info(name: str, osc_port: int) -> bytes:
    """As VRChat answers."""
    extensions = {"ACCESS": True, "CLIPMODE": False, "RANGE": True, "TYPE": True, "VALUE": True}
    said = {
        "NAME": name,
        "EXTENSIONS": extensions,
        "OSC_IP": "127.0.0.1",
        "OSC_PORT": osc_port,
        "OSC_TRANSPORT": "UDP",
    }
    return json.dumps(said).encode()


class _Handler(BaseHTTPRequestHandler):
    answer = b""
    status = 200

    def do_GET(self) -> None:
        self.send_response(self.status if self.path == "/?HOST_INFO" else 404)
        self.send_header("Content-Length", str(len(self.answer)))
        self.end_headers()
        self.wfile.write(self.answer)

    def log_message(self, *args: object) -> None:
        """Quiet."""


@contextmanager
def answering(answer: bytes, status: int = 200) -> Iterator[int]:
    """An HTTP service on 127.0.0.1 that answers this to HOST_INFO; its port."""
    handler = type("Handler", (_Handler,), {"answer": answer, "status": status})
    server = ThreadingHTTPServer((LOOPBACK, 0), handler)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    try:
        yield server.server_address[1]
    finally:
        server.shutdown()
        server.server_close()


@dataclass(frozen=True)
class FakeVRChat:
    """One that is announced. listening: its OSC."""

    listening: socket.socket

    @property
    def osc(self) -> str:
        host, port = self.listening.getsockname()
        return f"{host}:{port}"


@contextmanager
def vrchat(
    network: "Zeroconf", name: str, *, answer: bytes | None = None, says_goodbye: bool = True
) -> Iterator[FakeVRChat]:
    """Announced until the end, or, without goodbye, as one that crashed."""
    from zeroconf import ServiceInfo  # of an extra

    with ExitStack() as opened:
        listening = opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        listening.bind((LOOPBACK, 0))
        listening.settimeout(30.0)
        said = host_info(name, listening.getsockname()[1]) if answer is None else answer
        port = opened.enter_context(answering(said))
        info = ServiceInfo(
            SERVICE,
            f"{name}.{SERVICE}",
            addresses=[socket.inet_aton(LOOPBACK)],
            port=port,
            server=f"{name}.local.",
        )
        # without asking first whether the name is taken, which takes a second
        network.register_service(info, cooperating_responders=True)
        if says_goodbye:
            opened.callback(network.unregister_service, info)
        yield FakeVRChat(listening)
