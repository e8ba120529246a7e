"""A subscriber that stores every frame with its arrival time, and queries the daemon's health."""

import json
from contextlib import ExitStack
from dataclasses import dataclass

import msgspec
import zenoh

from mocapd.bus.zenoh_client_config import client_config
from mocapd.clock import monotonic_ns
from mocapd.errors import UnavailableError
from mocapd.outputs import wire
from mocapd.outputs.messages import Health
from mocapd.outputs.wire import SkeletonFrame
from mocapd.outputs.zenoh import keys

CONNECT_S = 1.0
ANSWER_S = 2.0


@dataclass(frozen=True, slots=True)
class Heard:
    """A frame and its arrival time, CLOCK_MONOTONIC [ns]."""

    frame: SkeletonFrame
    arrival_ns: int


class Subscriber:
    """Used by one thread; frames arrive on Zenoh's thread, and are decoded on access."""

    def __init__(self, endpoint: str, instance: str) -> None:
        config = client_config(endpoint, timeout_s=CONNECT_S)
        self._config = zenoh.Config.from_json5(json.dumps(config))
        self._instance = instance
        self._session: zenoh.Session | None = None
        self._opened = ExitStack()
        self._received: list[tuple[int, bytes]] = []

    def __enter__(self) -> "Subscriber":
        return self

    def __exit__(self, *_: object) -> None:
        self._session = None
        self._opened.close()

    def connect(self) -> bool:
        """Try to connect once, unless connected; returns whether it is connected."""
        if self._session is None:
            try:
                self._session = self._opened.enter_context(zenoh.open(self._config))
            except zenoh.ZError:
                return False
            handler = zenoh.handlers.Callback(self._on_sample, indirect=False)
            self._session.declare_subscriber(keys.skeleton(self._instance, 0), handler)
        return True

    def _on_sample(self, sample: zenoh.Sample) -> None:
        self._received.append((monotonic_ns(), sample.payload.to_bytes()))

    @property
    def count(self) -> int:
        """Number of frames so far."""
        return len(self._received)

    def heard(self) -> list[Heard]:
        """Every frame so far, in order of arrival."""
        return [Heard(wire.decode(data), at_ns) for at_ns, data in tuple(self._received)]

    def health(self) -> Health:
        """The daemon's newest health message, at most a second old. Raises UnavailableError."""
        if self._session is not None:
            for reply in self._session.get(keys.health(self._instance), timeout=ANSWER_S):
                if reply.ok is not None:
                    return msgspec.msgpack.decode(reply.ok.payload.to_bytes(), type=Health)
        raise UnavailableError("the daemon sends no health message", "bench", "try `mocapd run`")
