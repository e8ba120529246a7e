"""What others do to the Zenoh socket: the short forms of `python -m tests.attacks`."""

import os
import socket
import struct
import subprocess
import sys
import time

import psutil

from mocapd.bus.zenoh_limits import MAX_MESSAGE_BYTES
from mocapd.client import Client, Link
from tests.attacks.herd import herd
from tests.attacks.newcomers import times_s
from tests.attacks.silent import silent_connections
from tests.cli.own_time import end_within, own_time
from tests.conftest import ROOT
from tests.outputs.frames import eventually, free_port
from tests.outputs.test_zenoh_sink import HEALTH
from tests.outputs.zenoh_pair import GET_S, other_program, running_sink

# A daemon that sends to its subscribers until somebody says so, then ends as `mocapd run` does.
DAEMON = """
import sys, threading
from mocapd.app.daemon.main_loop import end_despite_work
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.cli.own_time import own_time
from tests.outputs.frames import whole_frame
from tests.outputs.test_zenoh_sink import HEALTH
sink = ZenohSink(Params(port=int(sys.argv[1])), "pc")
sink.open()
sink.send_state(HEALTH)
print("open", flush=True)
ended = threading.Event()
threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
frame = whole_frame()
while not ended.wait(0.0005):
    sink.send(frame)
took_s = own_time()
sink.close()
print(took_s(), flush=True)
end_despite_work(0)
"""
LEASE_MS = 1500
FULL_S = 1.8  # after that the frozen ones' connections take no more, and a lease of theirs is over


def daemon(port: int) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", DAEMON, str(port)],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "open\n"
    return process


def test_frozen_games_hold_up_neither_newcomers_nor_the_end() -> None:
    port = free_port()
    with daemon(port) as process, herd(port, 1) as kept, herd(port, 8, lease_ms=LEASE_MS) as missed:
        kept.freeze()
        missed.freeze()
        time.sleep(FULL_S)
        # Zenoh now closes eight connections whose other side does not take what was sent
        assert None not in times_s(port, count=3, every_s=0.1, within_s=6.0)
        # and has not missed the ninth
        out, err = end_within(process, 5.0)
    assert (process.returncode, err) == (0, "")
    assert float(out) < 3.0  # Zenoh itself takes 10 s


def test_no_connection_waits_to_be_closed() -> None:
    with running_sink() as running, other_program(running.endpoint):

        def lingering() -> list[bool]:
            found = []
            for connection in psutil.Process().net_connections("tcp"):
                if connection.laddr.port == running.port and connection.raddr:
                    with socket.socket(fileno=os.dup(connection.fd)) as own:
                        option = own.getsockopt(socket.SOL_SOCKET, socket.SO_LINGER, 8)
                        found.append(struct.unpack("ii", option)[0] != 0)
            return found

        assert eventually(lambda: lingering() == [False])


def test_newcomers_are_served_beside_silent_connections() -> None:
    with running_sink() as running, silent_connections(running.port, 150):
        took_s = own_time()
        Client(Link(running.endpoint, connect_timeout_s=30.0)).close()
        assert took_s() < 3.0


def test_messages_larger_than_any_question_are_dropped() -> None:
    with running_sink() as running, other_program(running.endpoint) as session:
        running.sink.send_state(HEALTH)

        def answers(size: int, within_s: float = GET_S) -> int:
            key = "mocapd/v1/pc/health"
            replies = session.get(key, payload=b"x" * size, timeout=within_s)
            return sum(reply.ok is not None for reply in replies)

        assert answers(MAX_MESSAGE_BYTES - 1000) == 1
        assert answers(MAX_MESSAGE_BYTES + 1000, within_s=0.5) == 0
        assert answers(0) == 1
