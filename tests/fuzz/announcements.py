"""page-PID.json, by which a running page is found, what answers at its address, and where a VRChat was announced."""

import json
import os
import socket
import threading
from random import Random

from mocapd.outputs.vrchat.host_info import ask_host_info
from mocapd.web.runtime_file import Place as PagePlace
from mocapd.web.runtime_file import announce, begin_setup, running, withdraw
from mocapd.web.status_page import SetupAnswer, Status
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.network import own_ports
from tests.fuzz.row import Attempt, Place, WrongError, named
from tests.outputs.vrchat.fake_oscquery import host_info

_TOKENS = (
    "",
    "a b",
    "é",
    "../..",
    "a\\r\\nX: y",
    "\\u0000",
    "x" * 5000,
    "?&#",
    "@h/",
    "%00",
    "a_-Z",
)
_HEADS = (
    b"HTTP/1.1 200 OK", b"HTTP/1.0 200", b"HTTP/1.1 503 No", b"HTTP/1.1 302 Found\r\nLocation: http://127.0.0.1:1/",
    b"HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd", b"HTTP/1.1 401 No", b"HTTP/9 abc", b"ICY 200 OK", b"",
    b"HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 200 OK", b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked", b"SSH-2.0-x",
    b"HTTP/1.1 " + b"9" * 5000, b"HTTP/1.1 200 OK\r\n" + b"A: b\r\n" * 300, b"HTTP/1.1 200 OK\r\nX: " + b"y" * 70_000,
)  # fmt: skip


class _Answers:
    """Whoever connects is answered `data`, and left."""

    def __init__(self) -> None:
        self.data = b""
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._socket.getsockname()[1]
        own_ports.add(self.port)
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            one, _ = self._socket.accept()
            with one:
                one.settimeout(1.0)
                try:
                    one.recv(65536)
                    one.sendall(self.data)
                    one.shutdown(socket.SHUT_WR)
                    while one.recv(65536):
                        pass
                except OSError:
                    continue


def files(place: Place) -> Attempt:
    """page-PID.json, as `mocapd calibrate` reads it and the daemon takes it back."""
    answers = _Answers()
    answers.data = _answer(_HEADS[0], _status())
    announce(PagePlace(place.folder, place.folder), answers.port, "abc")
    (path,) = place.folder.glob("page-*.json")
    good = path.read_bytes()
    assert running(place.folder)

    def attempt(random: Random, number: int) -> bool:
        data = mistyped(random, good, JSON_VALUES)
        if random.random() < 0.1:
            data = good.replace(b'"abc"', b'"%s"' % random.choice(_TOKENS).encode())
        path.write_bytes(data)
        found = running(place.folder)
        withdraw(place.folder)
        return bool(found)

    return attempt


def answers(place: Place) -> Attempt:
    """What another program may say at the port that was announced."""
    server = _Answers()
    announce(PagePlace(place.folder, place.folder), server.port, "abc")
    url = f"http://127.0.0.1:{server.port}/?token=abc"

    def attempt(random: Random, number: int) -> bool:
        body = mistyped(random, random.choice((_status(), _refusal())), JSON_VALUES)
        server.data = _answer(random.choice(_HEADS), body)
        if random.random() < 0.5:
            server.data = damaged(random, _answer(_HEADS[number % 3], body))
        begun = named(lambda: begin_setup(url, "lens"))
        return bool(running(place.folder)) or begun

    return attempt


def host_infos(place: Place) -> Attempt:
    """What may answer where a VRChat was announced: HTTP, and its JSON."""
    server = _Answers()
    good = host_info("VRChat-Client-5F3A21", 9000)
    server.data = _answer(_HEADS[0], good)
    ask_host_info("127.0.0.1", server.port)

    def attempt(random: Random, number: int) -> bool:
        body = mistyped(random, good, JSON_VALUES)
        server.data = _answer(random.choice(_HEADS), body)
        if random.random() < 0.5:
            server.data = damaged(random, _answer(_HEADS[number % 3], body))
        info = ask_host_info("127.0.0.1", server.port, timeout_s=0.3)
        if not 0 < info.osc_port < 65536:
            raise WrongError(f"a port {info.osc_port} is taken")
        return True

    return attempt


def _answer(head: bytes, body: bytes) -> bytes:
    return head + b"\r\nContent-Length: %d\r\n\r\n" % len(body) + body


def _status() -> bytes:
    return _json(Status("0.2.0", os.getpid(), ("cam0",), None, True))


def _refusal() -> bytes:
    return _json(SetupAnswer("busy", "cam0", "wait"))


def _json(one: Status | SetupAnswer) -> bytes:
    return json.dumps({name: getattr(one, name) for name in one.__struct_fields__}).encode()
