"""HOST_INFO over HTTP: what VRChat says is read, and whatever else may be there is a named error, in time."""

import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest

from mocapd.errors import UnavailableError
from mocapd.outputs.vrchat.host_info import ask_host_info
from tests.outputs.frames import free_port
from tests.outputs.vrchat.fake_oscquery import LOOPBACK, answering, host_info

GOOD = host_info("VRChat-Client-5F3A21", 9123)


def changed(**said: object) -> bytes:
    return json.dumps(json.loads(GOOD) | said).encode()


def test_vrchats_answer_is_read() -> None:
    with answering(GOOD) as port:
        assert ask_host_info(LOOPBACK, port).osc_port == 9123


@pytest.mark.parametrize(
    ("answer", "status", "says"),
    [
        (GOOD, 404, "404"),
        (GOOD, 302, "302"),
        (b"", 200, "no answer"),
        (b"<html>", 200, "malformed"),
        (GOOD + b" " * 70_000, 200, "more than"),
        (b"[" * 60_000, 200, "no answer"),
        (changed(OSC_PORT=0), 200, "OSC_PORT"),
        (changed(OSC_PORT=65536), 200, "OSC_PORT"),
        (changed(OSC_PORT="9000"), 200, "OSC_PORT"),
        (changed(OSC_TRANSPORT="TCP"), 200, "not by UDP"),
        (changed(NAME="SlimeVR-Server"), 200, "no VRChat"),
        (changed(NAME=None), 200, "NAME"),
    ],
)
def test_what_is_no_vrchat_is_a_named_error(answer: bytes, status: int, says: str) -> None:
    with answering(answer, status) as port, pytest.raises(UnavailableError, match=says):
        ask_host_info(LOOPBACK, port)


def test_nobody_there_is_a_named_error() -> None:
    with pytest.raises(UnavailableError, match="refused"):
        ask_host_info(LOOPBACK, free_port())


@contextmanager
def dripping(head: bytes, drop: bytes) -> Iterator[int]:
    """Answers without an end, a drop now and then; its port."""
    with socket.create_server((LOOPBACK, 0)) as server:
        ended = threading.Event()

        def serve() -> None:
            one, _ = server.accept()
            with one, suppress(OSError):
                one.sendall(head)
                while not ended.wait(0.02):
                    one.sendall(drop)

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield server.getsockname()[1]
        ended.set()
        thread.join()


@pytest.mark.parametrize(
    ("head", "drop"),
    [
        (b"", b""),
        (b"HTTP/1.1 200 OK\r\n", b"A: b\r\n"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 5000\r\n\r\n", b" "),
        (b"HTTP/1.1 200 OK\r\n\r\n", b" "),
    ],
)
def test_an_answer_that_never_ends_is_not_waited_for(head: bytes, drop: bytes) -> None:
    with dripping(head, drop) as port:
        began_s = time.monotonic()
        with pytest.raises(UnavailableError):
            ask_host_info(LOOPBACK, port, timeout_s=0.2)
        assert time.monotonic() - began_s < 10.0  # the drops alone would take for ever
