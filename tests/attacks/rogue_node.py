"""A camera node that keeps to no rule, in a process of its own.

    python -m tests.attacks.rogue_node PORT NODE KIND

listens on 127.0.0.1, says `ready`, sends pictures as KINDS has it until its stdin ends, and then prints how many a second
it has sent.
"""

import json
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import zenoh

from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import CameraState
from tests.attacks.node_kinds import KINDS, SIZE_PX, NodeKind, good_picture
from tests.conftest import ROOT

CAMERA = "cam0"
RUN = 7
_FLAP_S = 0.3
_SESSION_S = 1.5  # of one that reconnects


class RogueNode:
    """Within a thread of its own from `start` to `stop`; `sent` counts pictures."""

    def __init__(self, port: int, node: str, kind: NodeKind) -> None:
        kind.picture(0)  # made before anybody waits for it
        self.sent = 0
        self._port, self._node, self._kind = port, node, kind
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End, and wait for it."""
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._over.is_set():
            with ExitStack() as opened:
                self._serve(opened, _SESSION_S if self._kind.reconnects else float("inf"))

    def _serve(self, opened: ExitStack, for_s: float) -> None:
        config = {
            "mode": "peer",
            "listen": {"endpoints": [f"tcp/127.0.0.1:{self._port}"]},
            "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        }
        session = opened.enter_context(zenoh.open(zenoh.Config.from_json5(json.dumps(config))))
        keys = camera_wire.state(self._node, CAMERA), camera_wire.clock(self._node)
        for key, answers in zip(keys, (self._states, self._times), strict=True):
            handler = zenoh.handlers.Callback(answers, indirect=False)
            opened.enter_context(session.declare_queryable(key, handler))
        alive = camera_wire.alive(self._node, CAMERA)
        token = session.liveliness().declare_token(alive)
        publisher = opened.enter_context(
            session.declare_publisher(
                camera_wire.picture(self._node, CAMERA),
                congestion_control=zenoh.CongestionControl.DROP,
                express=True,
            )
        )
        began_s = flapped_s = time.monotonic()
        first = self.sent
        while not self._over.is_set() and time.monotonic() - began_s < for_s:
            due_s = began_s + (self.sent - first) / self._kind.rate_hz
            if self._over.wait(max(0.0, due_s - time.monotonic())):
                break
            if self._kind.flaps and time.monotonic() - flapped_s > _FLAP_S:
                flapped_s = time.monotonic()
                token.undeclare()  # type: ignore[no-untyped-call]
                token = session.liveliness().declare_token(alive)
            stamp = self._kind.stamp(self.sent, RUN)
            publisher.put(self._kind.picture(self.sent), attachment=stamp)
            self.sent += 1

    def _states(self, query: zenoh.Query) -> None:
        good = CameraState(self._node, CAMERA, "live", "", SIZE_PX, 30.0, False, RUN)
        with query:
            for answer in self._kind.states(good):
                query.reply(camera_wire.state(self._node, CAMERA), answer)

    def _times(self, query: zenoh.Query) -> None:
        with query:
            for answer in self._kind.clock(RUN):
                query.reply(camera_wire.clock(self._node), answer)


class RogueProcess:
    """One of them elsewhere; `rate_hz`: that it has sent, known in the end."""

    rate_hz = 0.0

    def __init__(self, port: int, node: str) -> None:
        self.address = f"zenoh://127.0.0.1:{port}/{node}/{CAMERA}"


@contextmanager
def rogue_process(port: int, node: str, kind: str) -> Iterator[RogueProcess]:
    """A node of this kind that is ready."""
    words = [sys.executable, "-m", "tests.attacks.rogue_node", str(port), node, kind]
    with subprocess.Popen(
        words, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        there = RogueProcess(port, node)
        try:
            yield there
        finally:
            process.stdin.close()
            there.rate_hz = float(process.stdout.readline() or 0.0)


def main() -> None:
    """See the module."""
    port, name, kind = int(sys.argv[1]), sys.argv[2], sys.argv[3]
    good_picture(0)
    node = RogueNode(port, name, KINDS[kind])
    node.start()
    began_s = time.monotonic()
    print("ready", flush=True)
    sys.stdin.read()
    rate_hz = node.sent / (time.monotonic() - began_s)
    node.stop()
    print(rate_hz, flush=True)


if __name__ == "__main__":
    main()
