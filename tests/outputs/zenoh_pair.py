"""A sink on a free port and a plain Zenoh session, as any other program would open it."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import msgspec
import zenoh

from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.outputs.frames import eventually, free_port

GET_S = 30.0


@dataclass(frozen=True)
class Running:
    """An open sink and where it is."""

    sink: ZenohSink
    port: int

    @property
    def endpoint(self) -> str:
        return f"tcp/127.0.0.1:{self.port}"

    def heard(self) -> None:
        """Wait until the sink knows of a subscriber."""
        assert eventually(lambda: self.sink.status().listeners != 0)


@contextmanager
def running_sink(port: int = 0, **params: object) -> Iterator[Running]:
    port = port or free_port()
    sink = ZenohSink(Params(port=port, **params), "pc")  # type: ignore[arg-type]
    sink.open()
    try:
        yield Running(sink, port)
    finally:
        sink.close()


@contextmanager
def running_router() -> Iterator[str]:
    """The endpoint of a session in router mode, that anybody may join; a router of its own is not to be had from PyPI."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    config = {
        "mode": "router",
        "listen": {"endpoints": [endpoint]},
        "scouting": {"multicast": {"enabled": False}},
    }
    with zenoh.open(zenoh.Config.from_json5(json.dumps(config))):
        yield endpoint


def other_program(endpoint: str, **more: object) -> zenoh.Session:
    """A client session written out by hand, independent of mocapd's own."""
    config = {
        "mode": "client",
        "connect": {"endpoints": [endpoint], "timeout_ms": 30_000},
        "scouting": {"multicast": {"enabled": False}},
    }
    return zenoh.open(zenoh.Config.from_json5(json.dumps(config | more)))


def ask(session: zenoh.Session, key: str) -> dict[str, tuple[str, object]]:
    """What queryables answer: key to encoding and decoded content."""
    answers: dict[str, tuple[str, object]] = {}
    for reply in session.get(key, timeout=GET_S):
        assert reply.ok is not None
        encoding, data = str(reply.ok.encoding), reply.ok.payload.to_bytes()
        decode = msgspec.msgpack.decode if "msgpack" in encoding else msgspec.json.decode
        answers[str(reply.ok.key_expr)] = (encoding, decode(data))
    return answers
