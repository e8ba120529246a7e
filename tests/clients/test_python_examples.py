"""The Python examples as a user starts them: on the canned tracker, and on everything that goes wrong."""

import json
import os
import re
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
import pytest
import zenoh

from mocapd.outputs import wire
from mocapd.outputs.osc.osc_frame import FrameBundles
from mocapd.outputs.osc.osc_sink import OscSink
from mocapd.outputs.osc.osc_sink import Params as OscParams
from mocapd.outputs.zenoh.zenoh_config import Params as ZenohParams
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.clients.canned_daemon import INSTANCE, canned_daemon
from tests.outputs.frames import eventually, free_port, whole_frame

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ROOT / "clients" / "python"
BLOCKS = re.findall(r"```python\n(.*?)```", (PYTHON / "README.md").read_text(), re.DOTALL)
NAN = float("nan")


class Example:
    """A program that runs until the test ends it; `line` is what it says next."""

    def __init__(self, *words: str | Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, *map(str, words)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"},
            text=True,
        )

    def line(self, pattern: str = "") -> str:
        """The next line that has this."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if re.search(pattern, line):
                return line.rstrip()
        raise AssertionError(f"it ended with {self.process.wait()} before it said {pattern!r}")

    def __enter__(self) -> "Example":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate(timeout=60)


@contextmanager
def canned(zenoh_port: int, osc_port: int) -> Iterator[None]:
    zenoh_sink = ZenohSink(ZenohParams(port=zenoh_port), INSTANCE)
    osc_sink = OscSink(OscParams((f"127.0.0.1:{osc_port}",)))
    with canned_daemon(zenoh_sink, osc_sink):
        yield


def test_every_example_tells_the_canned_persons_hand() -> None:
    port, osc_port = free_port(), free_port(socket.SOCK_DGRAM)
    assert len(BLOCKS) == 3
    assert all(len(block.splitlines()) <= 10 for block in BLOCKS)
    told_it = (r"left hand [-+]\d\.\d\d [+]1\.\d\d", r"\(?\[?-?\d\.\d+, 1\.\d+, ")
    with canned(port, osc_port):
        for name, where in (
            ("print_pose.py", f"tcp/127.0.0.1:{port}"),
            ("print_pose_zenoh.py", f"tcp/127.0.0.1:{port}"),
            ("print_pose_osc.py", str(osc_port)),
        ):
            with Example(PYTHON / name, where) as program:
                assert program.line(told_it[0])
        for block in BLOCKS:
            text = block.replace("7447", str(port)).replace("39541", str(osc_port))
            with Example(
                "-c", text.replace("stream()", f'stream("tcp/127.0.0.1:{port}")')
            ) as program:
                assert program.line(told_it[1])


def test_without_a_daemon_that_is_said() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    names = ("print_pose.py", "print_pose_zenoh.py")
    with Example(PYTHON / names[0], endpoint) as one, Example(PYTHON / names[1], endpoint) as other:
        for program in (one, other):
            assert "start `mocapd run`" in program.line(re.escape(endpoint))
            assert program.process.wait(60) == 69


def test_a_taken_port_is_said() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        with Example(PYTHON / "print_pose_osc.py", str(port)) as program:
            assert f"port {port} cannot be had" in program.line()
            assert program.process.wait(60) == 69


def changed(**changes: object) -> bytes:
    """A frame as msgpack, with fields that no daemon of ours would send."""
    tree = msgspec.msgpack.decode(wire.encode_msgpack(whole_frame(seq=5)))
    return msgspec.msgpack.encode(tree | changes)


def with_hand(position: object) -> bytes:
    tree = msgspec.msgpack.decode(wire.encode_msgpack(whole_frame(seq=6)))
    tree["joints"]["leftHand"]["p"] = position
    return msgspec.msgpack.encode(tree)


@pytest.mark.parametrize("name", ["print_pose.py", "print_pose_zenoh.py"])
def test_what_is_wrong_with_a_message_is_said_and_survived(name: str) -> None:
    port = free_port()
    config = {
        "mode": "peer",
        "listen": {"endpoints": [f"tcp/127.0.0.1:{port}"]},
        "scouting": {"multicast": {"enabled": False}},
    }
    good = wire.encode_msgpack(whole_frame(seq=7))
    with (
        zenoh.open(zenoh.Config.from_json5(json.dumps(config))) as session,
        session.liveliness().declare_token(f"mocapd/v1/{INSTANCE}/alive"),
    ):
        publisher = session.declare_publisher(f"mocapd/v1/{INSTANCE}/skeleton/0")
        with Example(PYTHON / name, f"tcp/127.0.0.1:{port}") as program:
            assert eventually(lambda: "true" in str(publisher.matching_status).lower())
            for payload, encoding, said in (
                (good, wire.MSGPACK, "     7  left hand"),
                (good, "application/msgpack;mocapd.Skeleton.v2", "mocapd.Skeleton.v2"),
                (b"\xc1garbage", wire.MSGPACK, "ignored: "),
                (changed(joints=3), wire.MSGPACK, "ignored: "),
                (changed(joints={}), wire.MSGPACK, "     5  nobody there"),
                (
                    with_hand([NAN, 1.0, 0.0]),
                    wire.MSGPACK,
                    "ignored: .*(no number|Expected `float`)",
                ),
                (with_hand([1.0]), wire.MSGPACK, "ignored: "),
                (changed(seq=float("inf")), wire.MSGPACK, "ignored: "),
                (good, wire.MSGPACK, "     7  left hand"),
            ):
                publisher.put(payload, encoding=encoding)
                assert re.search(said, program.line())
            assert "no frame for 2 s" in program.line()
            publisher.put(good, encoding=wire.MSGPACK)
            assert "left hand" in program.line("left hand")


def test_what_is_wrong_with_a_datagram_is_said_and_survived() -> None:
    frame = whole_frame(seq=7)
    hand = next(bytes(one) for one in FrameBundles(frame).fill(frame) if b"leftHand\0" in one)
    tags = b",fffffffffffff\0\0"
    x_at = hand.index(tags, hand.index(b"leftHand\0")) + len(tags)
    not_a_number = hand[:x_at] + struct.pack(">f", NAN) + hand[x_at + 4 :]
    port = free_port(socket.SOCK_DGRAM)
    with (
        Example(PYTHON / "print_pose_osc.py", str(port)) as program,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        assert "no frame on port" in program.line()  # it listens, and says that nobody sends
        for datagram, said in (
            (hand, "     7  left hand"),
            (b"garbage", "ignored: "),
            (hand[:-7], "ignored: "),
            (hand.replace(b"/mocapd/v1/", b"/mocapd/v2/"), "ignored: /mocapd/v2/frame"),
            (not_a_number, "     7  ignored: .* no number"),
            (b"#bundle\0" + bytes(8) + b"\xff\xff\xff\xff", "ignored: "),
            (hand, "     7  left hand"),
        ):
            sender.sendto(datagram, ("127.0.0.1", port))
            assert re.search(said, program.line(said))
