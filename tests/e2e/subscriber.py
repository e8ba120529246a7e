"""A game on the other side: receives frames over Zenoh and OSC and prints what came, as JSON.

    python -m tests.e2e.subscriber ENDPOINT OSC_PORT FRAMES

Uses Zenoh and python-osc themselves, and of mocapd nothing but the documented keys.
"""

import json
import sys
import threading
import time
from typing import Any

import msgspec
import zenoh
from pythonosc.dispatcher import Dispatcher
from pythonosc.osc_server import ThreadingOSCUDPServer

PATIENCE_S = 600.0  # the first daemon ever makes the pose database


def main() -> None:
    """Wait for the daemon, then on both ways for so many frames, live ones and one of several cameras among them.

    How many come of one camera, or of nobody, is up to how busy the machine is.
    """
    endpoint, osc_port, frames = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    addresses: dict[str, int] = {}
    enough = threading.Event()

    def heard(address: str, *_: object) -> None:
        addresses[address] = addresses.get(address, 0) + 1
        if max(addresses.values()) >= frames:
            enough.set()

    dispatcher = Dispatcher()
    dispatcher.set_default_handler(heard)
    server = ThreadingOSCUDPServer(("127.0.0.1", osc_port), dispatcher)
    threading.Thread(target=server.serve_forever, daemon=True).start()

    received: list[dict[str, Any]] = []
    give_up_s = time.monotonic() + PATIENCE_S
    with connected(endpoint) as session:
        subscriber = session.declare_subscriber(
            "mocapd/v1/*/skeleton/0", zenoh.handlers.FifoChannel(256)
        )
        for sample in subscriber:
            received.append(msgspec.msgpack.decode(sample.payload.to_bytes()))
            live = [one["cameras"] for one in received if one["tracking"] == "live"]
            if len(live) >= frames and any(len(cameras) > 1 for cameras in live):
                break
            if time.monotonic() > give_up_s:
                break
        health = [
            msgspec.msgpack.decode(reply.ok.payload.to_bytes())
            for reply in session.get("mocapd/v1/*/health", timeout=30.0)
            if reply.ok
        ]
    enough.wait(60.0)
    server.shutdown()
    print(json.dumps({"zenoh": received, "osc": addresses, "health": health}))


def connected(endpoint: str) -> zenoh.Session:
    """A session as soon as the daemon listens."""
    config = {
        "mode": "client",
        "connect": {"endpoints": [endpoint], "timeout_ms": 1000},
        "scouting": {"multicast": {"enabled": False}},
    }
    give_up_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            return zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
        except zenoh.ZError:
            if time.monotonic() > give_up_s:
                raise
        time.sleep(0.2)


if __name__ == "__main__":
    main()
