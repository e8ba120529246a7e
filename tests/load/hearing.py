"""`python -m tests.load.hearing ENDPOINT COUNT INSTANCE...`: so many subscribers, each with a session of its own.

To `begin` they count anew; to `tell` it answers with what they heard since, as JSON: for each its rate [Hz], the share
that it missed, and all latencies from publication to arrival as percentiles [ms].
"""

import json
import sys
from contextlib import ExitStack

import msgspec
import numpy as np
import zenoh

from mocapd.bus.zenoh_client_config import client_config
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.outputs.zenoh import keys

CONNECT_S = 20.0


class Told(msgspec.Struct):
    """What is needed of a frame; the rest is skipped."""

    seq: int
    publish_monotonic_ns: int


_DECODER = msgspec.msgpack.Decoder(Told)


class Hearer:
    """One subscriber; frames come on Zenoh's thread."""

    def __init__(self, instance: str) -> None:
        self.key = keys.skeleton(instance, 0)
        self.begin()

    def begin(self) -> None:
        """Count anew."""
        self._came: list[tuple[int, int, int]] = []

    def take(self, sample: zenoh.Sample) -> None:
        """A frame."""
        now_ns = monotonic_ns()
        told = _DECODER.decode(sample.payload.to_bytes())
        self._came.append((told.seq, told.publish_monotonic_ns, now_ns))

    def heard(self) -> "np.ndarray[tuple[int, int], np.dtype[np.int64]]":
        """(N,3): number, publication and arrival [ns]."""
        return np.array(self._came, dtype=np.int64).reshape(-1, 3)


def main() -> None:
    """Until stdin ends."""
    endpoint, count, *instances = sys.argv[1:]
    hearers = [Hearer(instances[i % len(instances)]) for i in range(int(count))]
    config = zenoh.Config.from_json5(json.dumps(client_config(endpoint, timeout_s=CONNECT_S)))
    with ExitStack() as opened:
        for hearer in hearers:
            session = opened.enter_context(zenoh.open(config))
            handler = zenoh.handlers.Callback(hearer.take, indirect=False)
            opened.enter_context(session.declare_subscriber(hearer.key, handler))
        print("ready", flush=True)
        for line in sys.stdin:
            if line.strip() == "begin":
                for hearer in hearers:
                    hearer.begin()
            else:
                print(json.dumps(_told(hearers)), flush=True)


def _told(hearers: list[Hearer]) -> dict[str, list[float]]:
    rates, missed, latencies = [], [], []
    for hearer in hearers:
        heard = hearer.heard()
        if len(heard) < 2:
            rates.append(0.0)
            missed.append(1.0)
            continue
        lasted_ns = float(heard[-1, 2] - heard[0, 2])
        rates.append((len(heard) - 1) * NS_PER_S / lasted_ns)
        missed.append(1.0 - len(heard) / float(heard[-1, 0] - heard[0, 0] + 1))
        latencies.append((heard[:, 2] - heard[:, 1]) / 1e6)
    # a sample of all, as one sends them through a pipe
    every_ms = np.sort(np.concatenate(latencies)) if latencies else np.zeros(0)
    picked_ms = every_ms[np.linspace(0, len(every_ms) - 1, min(2000, len(every_ms))).astype(int)]
    return {"rates_hz": rates, "missed": missed, "latencies_ms": picked_ms.round(3).tolist()}


if __name__ == "__main__":
    main()
